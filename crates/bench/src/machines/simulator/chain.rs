//! The signal chain in front of the actuator: delay, dead zone, gain asymmetry, saturation and slew
//! limit.
//!
//! The command is a sequence of stretches. Within each it is a linear function of the input and of
//! time, so all kinks are at the boundaries.

use std::f64::consts::TAU;

use rustfft::FftPlanner;

use super::effect::Effect;
use super::outsider::Outsider;
use super::slew::slew_limited;
use crate::measurement::Complex;

/// Bisection steps that locate an instant to the rounding error of the time.
const HALVINGS: usize = 50;
/// Number of instants per period of the highest input line between which crossings of a level are
/// searched. If the input crosses a level twice between two instants, it is missed; it then exceeds
/// the level by no more than (2π/1024)²/8 = 5e-6 of the amplitude.
const INTERVALS_PER_PERIOD: usize = 1024;

/// A stretch of time in which the command is offset + gain·u(t) + slope·(t − from).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    pub(super) offset: f64,
    pub(super) gain: f64,
    pub(super) slope: f64,
}

/// A periodic input.
pub(super) struct Input {
    lines: Vec<Complex>,
    omega_rad_s: f64,
}

impl Input {
    /// u(t) at any time.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        self.value_and_rate(time_s).0
    }

    /// u(t) and u'(t).
    pub(super) fn value_and_rate(&self, time_s: f64) -> (f64, f64) {
        let turn = Complex::from_polar(1.0, self.omega_rad_s * time_s);
        let mut phasor = Complex::new(1.0, 0.0);
        let (mut value, mut rate) = (0.0, 0.0);
        for (k, line) in self.lines.iter().enumerate() {
            let turned = line * phasor;
            value += turned.re;
            rate -= k as f64 * self.omega_rad_s * turned.im;
            phasor *= turn;
        }
        (value, rate)
    }

    pub(super) fn period_s(&self) -> f64 {
        TAU / self.omega_rad_s
    }

    /// Length of the intervals in which events are searched, s.
    pub(super) fn search_interval_s(&self) -> f64 {
        self.period_s() / (INTERVALS_PER_PERIOD * self.lines.len().saturating_sub(1).max(1)) as f64
    }

    /// u(t) at `count` instants of the period, by one inverse FFT.
    fn sampled(&self, count: usize) -> Vec<f64> {
        let mut values = vec![Complex::new(0.0, 0.0); count];
        values.iter_mut().zip(&self.lines).for_each(|(value, line)| *value = *line);
        FftPlanner::new().plan_fft_inverse(count).process(&mut values);
        values.iter().map(|value| value.re).collect()
    }
}

/// The command to the actuator, over one period.
pub(super) struct Command {
    input: Input,
    stretches: Vec<Stretch>,
}

impl Command {
    pub(super) fn periodic(effects: &[Effect], omega_rad_s: f64, lines: &[Complex]) -> Self {
        let delay_s: f64 = effects
            .iter()
            .map(|effect| if let Effect::TransportDelay { delay } = effect { *delay } else { 0.0 })
            .sum();
        let delayed = |(k, line): (usize, &Complex)| {
            line * Complex::from_polar(1.0, -(k as f64) * omega_rad_s * delay_s)
        };
        let lines = lines.iter().enumerate().map(delayed).collect();
        let input = Input { lines, omega_rad_s };
        let mut stretches = Shape::of(effects).stretches(&input);
        for effect in effects {
            if let Effect::SlewLimit { rate } = effect {
                stretches = slew_limited(&input, &stretches, *rate);
            }
        }
        Self { input, stretches }
    }

    /// The command for a sampled input, linear or held between samples. It is cut at every multiple
    /// of `step_s`, so that integration steps end there. Before the first sample the input is
    /// constant.
    pub(super) fn sampled_input(
        effects: &[Effect],
        step_s: f64,
        values: &[f64],
        hold: bool,
    ) -> Self {
        let mut delay_s = 0.0;
        let mut rate = f64::INFINITY;
        for effect in effects {
            match *effect {
                Effect::TransportDelay { delay } => delay_s += delay,
                Effect::SlewLimit { rate: limit } => rate = limit,
                _ => {}
            }
        }
        let shape = Shape::of(effects);
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

/// The static nonlinearity: dead zone, gain asymmetry and saturation in series, or quantisation.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shape {
    half_width: f64,
    gamma: f64,
    limit: f64,
    /// Step of the quantisation, which replaces the other three.
    step: Option<f64>,
}

impl Shape {
    fn of(effects: &[Effect]) -> Self {
        let mut shape = Self { half_width: 0.0, gamma: 0.0, limit: f64::INFINITY, step: None };
        for effect in effects {
            match *effect {
                Effect::ActuatorDeadZone { half_width } => shape.half_width = half_width,
                Effect::GainAsymmetry { gamma } => shape.gamma = gamma,
                Effect::ActuatorSaturation { limit } => shape.limit = limit,
                Effect::Outside(Outsider::InputQuantisation { step }) => shape.step = Some(step),
                _ => {}
            }
        }
        shape
    }

    /// Offset and gain of the linear piece at input u.
    fn line(&self, u: f64) -> (f64, f64) {
        if let Some(step) = self.step {
            return (step * (u / step).round(), 0.0);
        }
        if self.half_width > 0.0 && u.abs() <= self.half_width {
            return (0.0, 0.0);
        }
        let side = u.signum();
        let gain = 1.0 + side * self.gamma;
        let offset = -side * self.half_width * gain;
        if (offset + gain * u).abs() > self.limit {
            (side * self.limit, 0.0)
        } else {
            (offset, gain)
        }
    }

    /// Values of u at which the linear piece changes; those of a quantisation up to |u| =
    /// `largest`.
    fn levels(&self, largest: f64) -> Vec<f64> {
        if let Some(step) = self.step {
            let most = (largest / step).floor() as i64;
            return (-most - 1..=most).map(|n| (n as f64 + 0.5) * step).collect();
        }
        let mut levels = Vec::new();
        if self.half_width > 0.0 {
            levels.extend([-self.half_width, self.half_width]);
        } else if self.gamma != 0.0 {
            levels.push(0.0);
        }
        if self.limit.is_finite() {
            let level =
                |side: f64| side * (self.limit / (1.0 + side * self.gamma) + self.half_width);
            levels.extend([level(-1.0), level(1.0)]);
        }
        levels
    }

    fn stretches(&self, input: &Input) -> Vec<Stretch> {
        let period_s = input.period_s();
        let levels = self.levels(input.lines.iter().map(|line| line.norm()).sum());
        let mut bounds_s = vec![0.0];
        if !levels.is_empty() {
            let interval_count = (period_s / input.search_interval_s()).round() as usize;
            let time_s = |i: usize| period_s * i as f64 / interval_count as f64;
            let values: Vec<f64> = (0..=interval_count).map(|i| input.at(time_s(i))).collect();
            for (i, pair) in values.windows(2).enumerate() {
                let mut crossed: Vec<f64> = levels
                    .iter()
                    .filter(|level| (pair[0] > **level) != (pair[1] > **level))
                    .map(|level| {
                        let changed = |t: f64| (input.at(t) > *level) != (pair[0] > *level);
                        first_change(time_s(i), time_s(i + 1), changed)
                    })
                    .collect();
                crossed.sort_by(f64::total_cmp);
                bounds_s.extend(crossed);
            }
        }
        bounds_s.push(period_s);
        bounds_s.dedup_by(|later, earlier| *later - *earlier < 1e-13 * period_s);
        if let Some(last) = bounds_s.last_mut() {
            *last = period_s;
        }
        let stretch = |bounds: &[f64]| {
            let (offset, gain) = self.line(input.at(0.5 * (bounds[0] + bounds[1])));
            Stretch { from_s: bounds[0], to_s: bounds[1], offset, gain, slope: 0.0 }
        };
        bounds_s.windows(2).map(stretch).collect()
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

/// The instant at which `changed` becomes true, by bisection; it must be true at `to_s`.
pub(super) fn first_change(from_s: f64, to_s: f64, changed: impl Fn(f64) -> bool) -> f64 {
    let (mut before, mut after) = (from_s, to_s);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + after);
        if changed(middle) {
            after = middle;
        } else {
            before = middle;
        }
    }
    after
}
