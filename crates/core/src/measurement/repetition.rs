//! Tests whether a signal repeats with a given period.
//!
//! With x the signal minus its mean and L the period, the change from one period to the next is
//! d(n) = x(n + L) − x(n). If the period is right, d is the difference of two noise samples: its
//! rms is √2 times that of the noise, and successive samples are hardly correlated. If the period
//! is wrong, d contains the signal itself, which is smooth, so successive samples are correlated.

/// Largest rms(d)/rms(x) of a signal that repeats: 1 − r of the module `period` is then 0.75.
const CHANGE_LIMIT: f64 = 0.707;

/// The same limit if d is correlated (see [`CORRELATION_LIMIT`]). Tuned.
const CORRELATED_CHANGE_LIMIT: f64 = 0.3;

/// d counts as correlated above this lag-one autocorrelation, which measurement noise rarely
/// reaches. Tuned.
const CORRELATION_LIMIT: f64 = 0.5;

/// Fewest samples of d.
const FEWEST: usize = 8;

/// Standard errors by which limits are widened where d has few samples. Of c samples of white
/// noise, the rms has a relative standard error of 1/√(2c), and the lag-one autocorrelation one of
/// about 1/√(c + 9): of a million drawings, at most 1e-4 exceed the widened limit, for any c from 8
/// to 64.
const STANDARD_ERRORS: f64 = 4.0;

/// rms(d)/rms(x) above which the user is told of the change.
const REMARK_LIMIT: f64 = 0.1;

/// The change d from one period to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// rms(d)/rms(x).
    pub share: f64,
    /// Lag-one autocorrelation of d, as 1 − ½·mean(Δd²)/mean(d²): 1 for a constant.
    lag_one_correlation: f64,
    /// Number of samples of d.
    compared: usize,
}

impl Change {
    /// Computes it for a signal with `samples` samples per period; `None` if the signal is hardly
    /// longer than one period, or constant.
    pub fn of(signal: &[f64], samples: f64) -> Option<Self> {
        let (whole, fraction) = (samples.floor() as usize, samples.fract());
        // A period may be stated as any number.
        let ends = whole.saturating_add(1);
        let count = signal.len().checked_sub(ends).filter(|count| *count >= FEWEST)?;
        let mean = signal.iter().sum::<f64>() / signal.len() as f64;
        let size = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / signal.len() as f64;
        let later =
            |n: usize| signal[n + whole] + fraction * (signal[n + whole + 1] - signal[n + whole]);
        let changes: Vec<f64> = (0..count).map(|n| later(n) - signal[n]).collect();
        let squares: f64 = changes.iter().map(|d| d * d).sum();
        let steps: f64 = changes.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
        let mean_ratio = steps / squares * count as f64 / (count - 1) as f64;
        let lag_one_correlation = if squares > 0.0 { 1.0 - 0.5 * mean_ratio } else { 0.0 };
        (size > 0.0).then(|| Self {
            share: (squares / count as f64 / size).sqrt(),
            lag_one_correlation,
            compared: count,
        })
    }

    /// Whether the signal contradicts the period.
    pub fn contradicts(self) -> bool {
        let compared = self.compared as f64;
        let change_limit = CHANGE_LIMIT * (1.0 + STANDARD_ERRORS / (2.0 * compared).sqrt());
        self.share > change_limit || (self.share > CORRELATED_CHANGE_LIMIT && self.is_smooth())
    }

    /// Whether the change is correlated from sample to sample, as noise is not.
    pub fn is_smooth(self) -> bool {
        let chance = STANDARD_ERRORS / (self.compared as f64 + 9.0).sqrt();
        self.lag_one_correlation > CORRELATION_LIMIT.max(chance)
    }

    /// Whether the change is large enough for a remark.
    pub fn is_large(self) -> bool {
        self.share > REMARK_LIMIT
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Ten periods of a signal with two lines, with noise of standard deviation `noise`.
    fn signal(samples: f64, noise: f64) -> Vec<f64> {
        signal_of(3, samples, noise)
    }

    fn signal_of(seed: u64, samples: f64, noise: f64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let value = |n: usize| {
            let angle = std::f64::consts::TAU * n as f64 / samples;
            let noise: f64 = noise * Distribution::<f64>::sample(&StandardNormal, &mut rng);
            angle.sin() + 0.5 * (3.0 * angle).cos() + noise
        };
        (0..(10.0 * samples) as usize).map(value).collect()
    }

    // Linear interpolation has a relative error of (ω/fs)²/8: 7e-4 at the third harmonic.
    #[test]
    fn a_signal_repeats_with_its_period_though_that_is_no_whole_number_of_samples() {
        let change = Change::of(&signal(250.4, 0.0), 250.4).unwrap();
        assert!(change.share < 1e-3, "{change:?}");
    }

    // √2·0.4/√(0.625 + 0.16) = 0.64; standard error 2 %.
    #[test]
    fn noise_alone_contradicts_no_period() {
        let change = Change::of(&signal(250.0, 0.4), 250.0).unwrap();
        assert!((change.share - 0.64).abs() < 0.04, "{change:?}");
        assert!(change.is_large() && !change.contradicts());
    }

    #[test]
    fn a_period_that_is_wrong_by_a_twentieth_is_contradicted() {
        for wrong in [237.0, 262.0] {
            let change = Change::of(&signal(250.0, 0.02), wrong).unwrap();
            assert!(change.contradicts(), "{change:?}");
        }
    }

    #[test]
    fn a_few_samples_of_a_second_period_contradict_a_wrong_period_and_noise_does_not() {
        // Nine samples are compared: with what the signal is 80 samples later, and with where it
        // repeats.
        let smooth = signal(250.0, 0.0);
        assert!(Change::of(&smooth[..340], 330.0).unwrap().contradicts());
        for seed in 0..200 {
            let noisy = signal_of(seed, 250.0, 0.3);
            assert!(!Change::of(&noisy[..260], 250.0).unwrap().contradicts(), "{seed}");
        }
    }

    #[test]
    fn one_period_or_a_constant_cannot_be_tested() {
        assert_eq!(Change::of(&signal(250.0, 0.0)[..258], 250.0), None);
        assert_eq!(Change::of(&[2.0; 1000], 100.0), None);
    }

    #[test]
    fn a_period_longer_than_any_signal_is_not_compared() {
        let signal = signal(20.0, 0.0);
        for samples in [1e308, usize::MAX as f64, 1e15] {
            assert_eq!(Change::of(&signal, samples), None);
        }
    }
}
