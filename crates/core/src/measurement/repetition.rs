//! Whether a signal repeats with the period that is stated for it.
//!
//! With x the signal less its mean and L the period, what changes from one period to the next is
//! d(n) = x(n + L) − x(n). Noise makes it as large as √2 times the noise, and hardly alike from
//! one sample to the next; a period that is wrong leaves the signal's own course in it.

/// Root mean square of d over that of x beyond which nothing repeats: 1 − r of `period` is 0.75.
const NOTHING_REPEATS: f64 = 0.707;

/// The same where d has a course of its own.
const MUCH: f64 = 0.3;

/// Correlation of d with itself a sample later that noise of a sampled signal hardly has.
const COURSE: f64 = 0.5;

/// The same share from which on a change is said.
const WORTH_SAYING: f64 = 0.1;

/// What changes from one period to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// Root mean square of d as a share of that of x.
    pub share: f64,
    /// Correlation of d with itself a sample later.
    course: f64,
}

impl Change {
    /// Of a signal with so many samples a period; `None` where it holds no two of them, or is
    /// constant.
    pub fn of(signal: &[f64], samples: f64) -> Option<Self> {
        let (whole, fraction) = (samples.floor() as usize, samples.fract());
        let count = signal.len().checked_sub(whole + 1).filter(|count| *count > whole / 2)?;
        let mean = signal.iter().sum::<f64>() / signal.len() as f64;
        let size = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / signal.len() as f64;
        let later =
            |n: usize| signal[n + whole] + fraction * (signal[n + whole + 1] - signal[n + whole]);
        let changes: Vec<f64> = (0..count).map(|n| later(n) - signal[n]).collect();
        let squares: f64 = changes.iter().map(|d| d * d).sum();
        let products: f64 = changes.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let course = if squares > 0.0 { products / squares } else { 0.0 };
        (size > 0.0).then(|| Self { share: (squares / count as f64 / size).sqrt(), course })
    }

    /// Whether the signal contradicts the period.
    pub fn contradicts(self) -> bool {
        self.share > NOTHING_REPEATS || (self.share > MUCH && self.course > COURSE)
    }

    /// Whether it is worth a remark.
    pub fn is_large(self) -> bool {
        self.share > WORTH_SAYING
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Ten periods of two lines, with noise of this deviation.
    fn signal(samples: f64, noise: f64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let value = |n: usize| {
            let angle = std::f64::consts::TAU * n as f64 / samples;
            let noise: f64 = noise * Distribution::<f64>::sample(&StandardNormal, &mut rng);
            angle.sin() + 0.5 * (3.0 * angle).cos() + noise
        };
        (0..(10.0 * samples) as usize).map(value).collect()
    }

    // Linear interpolation errs by (ω/fs)²/8: 7e-4 of the line at the third harmonic.
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
    fn of_one_period_or_a_constant_nothing_is_said() {
        assert_eq!(Change::of(&signal(250.0, 0.0)[..260], 250.0), None);
        assert_eq!(Change::of(&[2.0; 1000], 100.0), None);
    }
}
