//! How a motion is sampled, and the noise of the samples.

use std::f64::consts::TAU;

use crate::measurement::Complex;

/// How a motion is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Samples in a period; more than twice the number of lines of input and response.
    pub samples: usize,
    /// Number of periods.
    pub periods: usize,
}

/// Standard deviations of the white noise of a record, and what rounding adds to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordNoise {
    /// Of every sample of the input, input units.
    pub input: f64,
    /// Of every sample of the response, response units.
    pub response: f64,
    /// Resolution to which a sensor rounds the response, noise and all, response units; 0 if it does
    /// not round.
    pub step: f64,
}

impl RecordNoise {
    /// All of it `factor` times as large.
    pub fn times(self, factor: f64) -> Self {
        let Self { input, response, step } = self;
        Self { input: factor * input, response: factor * response, step: factor * step }
    }

    /// Standard deviation of every sample of the response, with that of rounding: a step is uniform
    /// over its width.
    pub(super) fn response_std(&self) -> f64 {
        self.response.hypot(self.step / 12.0_f64.sqrt())
    }
}

impl Sampling {
    /// Lines of an input that a converter holds from each sample to the next, without their images:
    /// sin(x)/x·exp(−jx) of those of its samples, x = πk/N.
    pub fn held(self, lines: &[Complex]) -> Vec<Complex> {
        lines.iter().enumerate().map(|(k, line)| line * self.hold(k)).collect()
    }

    pub(super) fn hold(self, k: usize) -> Complex {
        let x = 0.5 * TAU * k as f64 / self.samples as f64;
        Complex::from_polar(if k == 0 { 1.0 } else { x.sin() / x }, -x)
    }

    /// Standard deviation of re and im of a harmonic, averaged over all periods, from that of a
    /// sample: √(2/(number of samples)) of it.
    pub(super) fn harmonic_std(self, sample_std: f64) -> f64 {
        sample_std * (2.0 / (self.samples * self.periods) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::machines::records::{PeriodicMotion, multisine};

    #[test]
    fn a_held_input_is_read_as_the_samples_that_are_held() {
        let sampling = Sampling { samples: 256, periods: 4 };
        let lines = multisine(20, 2.0, &mut ChaCha8Rng::seed_from_u64(1));
        let held = PeriodicMotion {
            omega_rad_s: 2.5,
            input: sampling.held(&lines),
            response: Vec::new(),
            mean_velocity: 0.0,
        };
        let read = held.read_before_holding(sampling);
        for (read, line) in read.input.iter().zip(&lines) {
            assert!((read - line).norm() < 1e-14 * 2.0);
        }
        // Half a sample late: line 20 of 256 samples by 20/256 of half a turn.
        let angle = (held.input[20] / lines[20]).arg();
        assert!((angle + 0.5 * TAU * 20.0 / 256.0).abs() < 1e-12, "{angle}");
    }
}
