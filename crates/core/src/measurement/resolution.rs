//! The rounding of samples, as by an encoder, as far as it repeats in every period.
//!
//! Samples that are multiples of a step q have an error of the variance q²/12. Where the periods
//! scatter by more than a step this error differs from period to period, and the scatter tells it.
//! Where they repeat to less than a step the same error repeats with them: no scatter tells it, and
//! no average over periods lowers it.
//!
//! Before rounding, let the samples scatter normally with standard deviation s. The mean error of
//! rounding x is (q/π)·Σ ((−1)ᵐ/m)·exp(−2π²m²s²/q²)·sin(2πmx/q), from the Fourier series of a
//! sawtooth, and of all x it has the variance D(s) = (q²/2π²)·Σ exp(−4π²m²s²/q²)/m². The scatter
//! that is seen is s² + q²/12 − D(s). (B. Widrow, I. Kollár, *Quantization Noise*, Cambridge 2008.)

use std::f64::consts::PI;

/// Differences of samples below this share of the largest are rounding errors of arithmetic.
const ARITHMETIC_SHARE: f64 = 1e-12;

/// Exponent a = 4π²s²/q² below which the sum of the series is taken as π²/6 − √(πa) + a/2, which leaves
/// out e^(−π²/a) and smaller: 1e-17. It is the integral of Σ exp(−am²) = ½·[√(π/a)·(1 + 2·Σ exp(−π²m²/a)) − 1].
const SMALL: f64 = 0.25;

/// Terms of the series above that; the next is below 1e-18.
const TERMS: u32 = 12;

/// Halvings of the interval in which s is searched, enough for all digits.
const HALVINGS: usize = 60;

/// Smallest difference of two different samples, 0 if all are alike. Unrounded samples have one that
/// is too small to matter.
pub(super) fn step(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let largest = samples.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let smallest = steps.filter(|step| *step > ARITHMETIC_SHARE * largest).reduce(f64::min);
    smallest.unwrap_or(0.0)
}

/// Variance D of the part of the rounding error that repeats, of samples with this step of which
/// the periods scatter with this variance.
pub(super) fn repeated_variance(step: f64, scatter: f64) -> f64 {
    if step <= 0.0 {
        return 0.0;
    }
    let scatter = scatter / (step * step);
    let seen = |s: f64| s * s + 1.0 / 12.0 - repeated(s);
    // Beyond one step nothing repeats.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match seen(middle) < scatter {
            true => low = middle,
            false => high = middle,
        }
    }
    step * step * repeated(low)
}

/// D for a step of 1.
fn repeated(s: f64) -> f64 {
    let a = (2.0 * PI * s).powi(2);
    let term = |m: u32| (-a * f64::from(m).powi(2)).exp() / f64::from(m).powi(2);
    let sum = match a < SMALL {
        true => PI * PI / 6.0 - (PI * a).sqrt() + 0.5 * a,
        false => (1..=TERMS).map(term).sum(),
    };
    sum / (2.0 * PI * PI)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn the_step_is_that_of_the_encoder() {
        let samples: Vec<f64> = (0..500).map(|n| (f64::from(n) * 0.1).sin()).collect();
        let rounded: Vec<f64> = samples.iter().map(|x| (x / 0.01).round() * 0.01).collect();
        assert!((step(&rounded) / 0.01 - 1.0).abs() < 1e-9);
        assert!(step(&samples) < 1e-4);
        assert_eq!(step(&[2.0, 2.0, 2.0 + 1e-15]), 0.0);
    }

    #[test]
    fn samples_that_repeat_exactly_repeat_all_of_their_error() {
        assert!((repeated_variance(3.0, 0.0) / 0.75 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn small_scatter_has_the_sum_of_the_whole_series() {
        for s in [0.001, 0.02, 0.0795, 0.0797, 0.2] {
            let a = (2.0 * PI * s).powi(2);
            let terms = (1..100_000).rev().map(f64::from);
            let series: f64 = terms.map(|m| (-a * m * m).exp() / (m * m)).sum();
            assert!((repeated(s) * 2.0 * PI * PI - series).abs() < 1e-13, "{s}");
        }
    }

    // Errors of 4000 places, each rounded 400 times: their variance has a relative standard error
    // of 1/√2000, and what each mean scatters by, (s² + q²/12)/400, adds to it.
    #[test]
    fn of_samples_that_scatter_as_much_repeats_as_drawn_errors_do() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for s in [0.02, 0.1, 0.2, 0.3] {
            let (mut repeats, mut scatters) = (0.0, 0.0);
            for _ in 0..4000 {
                let x: f64 = rng.random_range(0.0..10.0);
                let mut noisy = || {
                    let noise: f64 = StandardNormal.sample(&mut rng);
                    (x + s * noise).round()
                };
                let rounded: Vec<f64> = (0..400).map(|_| noisy()).collect();
                let mean = rounded.iter().sum::<f64>() / 400.0;
                let variance = rounded.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 399.0;
                repeats += ((mean - x).powi(2) - variance / 400.0) / 4000.0;
                scatters += variance / 4000.0;
            }
            let expected = repeated_variance(1.0, scatters);
            let error = 4.0 * (repeats + scatters / 400.0) / 2000.0_f64.sqrt();
            assert!((repeats - expected).abs() < error, "{s}: {repeats} {expected}");
        }
    }
}
