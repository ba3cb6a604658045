//! The signal chain in front of the actuator: delay, dead zone, gain asymmetry, saturation and slew
//! limit.
//!
//! The command is a sequence of stretches. Within each it is a linear function of the input and of
//! time, so all kinks are at the boundaries.

use std::f64::consts::TAU;

use super::input::{Input, Stretch, first_change};
use super::parts::Parts;
use super::shape::Shape;
use super::slew::slew_limited;
use crate::measurement::Complex;

/// The command to the actuator, over one period.
pub(super) struct Command {
    input: Input,
    stretches: Vec<Stretch>,
}

impl Command {
    pub(super) fn periodic(parts: &Parts, omega_rad_s: f64, lines: &[Complex]) -> Self {
        let delay_s = parts.delay_s;
        let delayed = |(k, line): (usize, &Complex)| {
            line * Complex::from_polar(1.0, -(k as f64) * omega_rad_s * delay_s)
        };
        let lines = lines.iter().enumerate().map(delayed).collect();
        let input = Input { lines, omega_rad_s };
        let mut stretches = Shape::of(parts).stretches(&input);
        if let Some(rate) = parts.slew_rate {
            stretches = slew_limited(&input, &stretches, rate);
        }
        Self { input, stretches }
    }

    /// The command for a sampled input, linear or held between samples. It is cut at every multiple
    /// of `step_s`, so that integration steps end there. Before the first sample the input is
    /// constant.
    pub(super) fn sampled_input(parts: &Parts, step_s: f64, values: &[f64], hold: bool) -> Self {
        let delay_s = parts.delay_s;
        let rate = parts.slew_rate.unwrap_or(f64::INFINITY);
        let shape = Shape::of(parts);
        let end_s = step_s * (values.len() - 1) as f64;
        let knots = (0..values.len()).flat_map(|n| {
            let time_s = n as f64 * step_s;
            [time_s, time_s + delay_s]
        });
        let mut bounds_s: Vec<f64> = knots.filter(|time_s| *time_s <= end_s).collect();
        bounds_s.sort_by(f64::total_cmp);
        bounds_s.dedup_by(|later, earlier| *later - *earlier < 1e-9 * step_s);
        let last = values.len() - 1;
        let mut stretches = Vec::new();
        let shaped = |u: f64| {
            let (offset, gain) = shape.line(u);
            offset + gain * u
        };
        let mut w = shaped(values[0]);
        for pair in bounds_s.windows(2) {
            let middle = (0.5 * (pair[0] + pair[1]) - delay_s) / step_s;
            let before = middle.floor().max(0.0) as usize;
            let u = |time_s: f64| {
                let place = (time_s - delay_s) / step_s - before as f64;
                match middle {
                    middle if middle < 0.0 => values[0],
                    _ if hold => values[before],
                    _ => values[before] + place * (values[(before + 1).min(last)] - values[before]),
                }
            };
            // The input is linear here, so the shaped input is piecewise linear.
            let levels = shape.levels(u(pair[0]).abs().max(u(pair[1]).abs()));
            let side = |time_s: f64| levels.iter().filter(|level| u(time_s) > **level).count();
            let mut from_s = pair[0];
            while from_s < pair[1] {
                // Evaluated just after the beginning, which may lie exactly on a level.
                let here = side(from_s + 1e-12 * step_s);
                let to_s = match side(pair[1] - 1e-12 * step_s) == here {
                    true => pair[1],
                    false => first_change(from_s + 1e-12 * step_s, pair[1], |t| side(t) != here),
                };
                let (offset, gain) = shape.line(u(0.5 * (from_s + to_s)));
                let x = |time_s: f64| offset + gain * u(time_s);
                push_rate_limited(&mut stretches, &x, [from_s, to_s], rate, &mut w);
                from_s = to_s;
            }
        }
        Self { input: Input { lines: Vec::new(), omega_rad_s: TAU / end_s }, stretches }
    }

    pub(super) fn period_s(&self) -> f64 {
        self.input.period_s()
    }

    /// The stretches in order; they fill the period, and the command has no kink within them.
    pub(super) fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// The command at `count` + 1 instants of a stretch, both ends included.
    pub(super) fn sampled(&self, stretch: &Stretch, count: usize) -> Vec<f64> {
        let Stretch { from_s, to_s, offset, gain, slope } = *stretch;
        // For an input with hundreds of lines the FFT is a thousand times faster than summation.
        if self.stretches.len() == 1 && count.is_power_of_two() && count > self.input.lines.len() {
            let mut input = self.input.sampled(count);
            input.push(input[0]);
            return input.into_iter().map(|u| offset + gain * u).collect();
        }
        let width_s = (to_s - from_s) / count as f64;
        let value = |i: usize| {
            let elapsed_s = i as f64 * width_s;
            let driven = if gain == 0.0 { 0.0 } else { gain * self.input.at(from_s + elapsed_s) };
            offset + driven + slope * elapsed_s
        };
        (0..=count).map(value).collect()
    }
}

/// Appends the output of a rate limiter for a linear input x on one interval, starting at output
/// w; updates w to the output at the end.
fn push_rate_limited(
    out: &mut Vec<Stretch>,
    x: &impl Fn(f64) -> f64,
    [from_s, to_s]: [f64; 2],
    rate: f64,
    w: &mut f64,
) {
    let mut add = |from_s: f64, to_s: f64, offset: f64, slope: f64| {
        if to_s > from_s {
            out.push(Stretch { from_s, to_s, offset, gain: 0.0, slope });
        }
    };
    let slope = (x(to_s) - x(from_s)) / (to_s - from_s);
    let ahead = x(from_s) - *w;
    let together = rate == f64::INFINITY || ahead.abs() <= 1e-12 * w.abs();
    if together && slope.abs() <= rate {
        add(from_s, to_s, x(from_s), slope);
        *w = x(to_s);
        return;
    }
    let ramp = rate * if together { slope.signum() } else { ahead.signum() };
    let start = *w;
    let met = |t: f64| !together && ahead * (x(t) - start - ramp * (t - from_s)) <= 0.0;
    if !met(to_s) {
        add(from_s, to_s, start, ramp);
        *w = start + ramp * (to_s - from_s);
        return;
    }
    let meets_s = first_change(from_s, to_s, met);
    add(from_s, meets_s, start, ramp);
    *w = x(meets_s);
    if meets_s < to_s {
        push_rate_limited(out, x, [meets_s, to_s], rate, w);
    }
}
