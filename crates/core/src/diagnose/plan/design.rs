//! Experiments that a plan may choose from, and how long they take.

use std::f64::consts::TAU;

use crate::answers::PlannedExperiment;

use super::setting::Setting;

/// Frequencies on the grid. Sweeps take every one, every second, third, fourth, sixth or eighth of them.
pub(super) const FREQUENCIES: usize = 25;

/// Magnitudes on the grid. Sweeps take the last, or every second from the second on.
pub(super) const MAGNITUDES: usize = 6;

/// Fewest repeats of an experiment: their scatter tells the noise.
pub(super) const FEWEST_REPEATS: usize = 2;

/// From twice so many repeats on, more than one is added at a time.
const MANY_REPEATS: usize = 32;

/// A point of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Magnitude of the input, input units.
    pub magnitude: f64,
    /// Frequency, rad/s.
    pub omega_rad_s: f64,
    /// Periods to settle.
    pub settle_periods: usize,
    /// Periods of a repeat.
    pub measured_periods: usize,
}

impl Point {
    /// Duration of one repeat, s.
    pub fn repeat_s(&self) -> f64 {
        self.measured_periods as f64 * TAU / self.omega_rad_s
    }

    /// Duration with settling of so many repeats, s; 0 of none.
    pub fn duration_s(&self, repeats: usize) -> f64 {
        if repeats == 0 {
            return 0.0;
        }
        let periods = self.settle_periods + repeats * self.measured_periods;
        periods as f64 * TAU / self.omega_rad_s
    }

    /// The experiment with so many repeats at a position in the order.
    pub fn experiment(&self, run: usize, repeats: usize) -> PlannedExperiment {
        PlannedExperiment {
            run,
            magnitude: self.magnitude,
            omega_rad_s: self.omega_rad_s,
            settle_periods: self.settle_periods,
            measured_periods: self.measured_periods,
            repeats,
            duration_s: self.duration_s(repeats),
            serves: None,
        }
    }
}

/// Samples in the shortest period of an excitation. All periods are whole numbers of its samples.
const SAMPLES: f64 = 100.0;

/// Time between two samples of an excitation, s.
pub(super) fn sample_s(setting: &Setting) -> f64 {
    TAU / setting.band_rad_s[1] / SAMPLES
}

/// Samples in a period of about this frequency (rad/s).
pub(super) fn samples_per_period(setting: &Setting, omega_rad_s: f64) -> usize {
    (TAU / omega_rad_s / sample_s(setting)).round().max(SAMPLES) as usize
}

/// All points of the grid: magnitude by magnitude, frequencies ascending. Their periods are whole numbers of
/// samples.
pub(super) fn grid(setting: &Setting) -> Vec<Point> {
    let between = |[low, high]: [f64; 2], index: usize, count: usize| {
        low * (high / low).powf(index as f64 / (count - 1) as f64)
    };
    (0..MAGNITUDES)
        .flat_map(|m| (0..FREQUENCIES).map(move |f| (m, f)))
        .map(|(m, f)| {
            let about = between(setting.band_rad_s, f, FREQUENCIES);
            let period_s = samples_per_period(setting, about) as f64 * sample_s(setting);
            let omega_rad_s = TAU / period_s;
            let [settle_periods, measured_periods] = setting.periods(omega_rad_s);
            let magnitude = between(setting.magnitudes, m, MAGNITUDES);
            Point { magnitude, omega_rad_s, settle_periods, measured_periods }
        })
        .collect()
}

/// Repeats of every point of the grid; 0 where it is not measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Design(pub Vec<usize>);

impl Design {
    /// No experiment.
    pub fn none(points: &[Point]) -> Self {
        Self(vec![0; points.len()])
    }

    /// Indices of the points that are measured.
    pub fn measured(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().enumerate().filter(|(_, repeats)| **repeats > 0).map(|(point, _)| point)
    }

    /// Duration of all experiments, s.
    pub fn duration_s(&self, points: &[Point]) -> f64 {
        self.0.iter().zip(points).map(|(repeats, point)| point.duration_s(*repeats)).sum()
    }

    /// The next larger number of repeats of a point, of which `fitting` more would fit into the time.
    /// Of a point with many repeats it is several at once, so that a long plan takes hardly more steps
    /// than a short one.
    pub fn more(&self, point: usize, fitting: usize) -> usize {
        let repeats = self.0[point];
        (repeats + (repeats / MANY_REPEATS).min(fitting).max(1)).max(FEWEST_REPEATS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_are_added_one_by_one_or_many_to_many_and_no_more_than_fit() {
        let design = Design(vec![0, 2, 63, 64, 320]);
        let more = |fitting: usize| (0..5).map(|point| design.more(point, fitting)).collect();
        let (ample, scarce): (Vec<usize>, Vec<usize>) = (more(1000), more(3));
        assert_eq!(ample, [FEWEST_REPEATS, 3, 64, 66, 330]);
        assert_eq!(scarce, [FEWEST_REPEATS, 3, 64, 66, 323]);
    }
}
