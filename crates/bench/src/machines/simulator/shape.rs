//! The static nonlinearity of the signal chain: dead zone, gain asymmetry and saturation in series,
//! or quantisation.

use super::input::{Input, Stretch, first_change};
use super::parts::Parts;

/// A nonlinearity that is linear within each of several pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    half_width: f64,
    gamma: f64,
    limit: f64,
    /// Step of the quantisation, which replaces the other three.
    step: Option<f64>,
}

impl Shape {
    pub(super) fn of(parts: &Parts) -> Self {
        Self {
            half_width: parts.dead_zone,
            gamma: parts.gain_asymmetry,
            limit: parts.limit,
            step: parts.quantum,
        }
    }

    /// Offset and gain of the linear piece at input u.
    pub(super) fn line(&self, u: f64) -> (f64, f64) {
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
    pub(super) fn levels(&self, largest: f64) -> Vec<f64> {
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

    /// The command for a periodic input, cut wherever the input crosses a level.
    pub(super) fn stretches(&self, input: &Input) -> Vec<Stretch> {
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
