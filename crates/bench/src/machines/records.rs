//! Sampled records of periodic motions, with white noise on input and response.

mod motion;
mod sampling;

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rustfft::FftPlanner;

use crate::measurement::Complex;
pub use motion::PeriodicMotion;
pub use sampling::{RecordNoise, Sampling};

/// Points of a period per highest line at which the peak of a multisine is looked for.
const POINTS_PER_LINE: usize = 16;

/// Lines 1 to `count` of equal size and random phase, half the peak-to-peak value of whose sum is
/// `magnitude` (input units).
pub fn multisine(count: usize, magnitude: f64, rng: &mut ChaCha8Rng) -> Vec<Complex> {
    let phases = (0..count).map(|_| Complex::from_polar(1.0, rng.random_range(0.0..TAU)));
    with_magnitude(phases, magnitude)
}

/// Lines 1 to `count` of equal size whose phases −πk²/`count` make a sweep of their sum (M. R. Schroeder
/// 1970, doi:10.1109/TIT.1970.1054411), half the peak-to-peak value of which is `magnitude` (input
/// units).
pub fn sweep(count: usize, magnitude: f64) -> Vec<Complex> {
    let phase = |k: usize| -0.5 * TAU * (k * k) as f64 / count as f64;
    with_magnitude((1..=count).map(|k| Complex::from_polar(1.0, phase(k))), magnitude)
}

fn with_magnitude(lines: impl Iterator<Item = Complex>, magnitude: f64) -> Vec<Complex> {
    let mut lines: Vec<Complex> = std::iter::once(Complex::new(0.0, 0.0)).chain(lines).collect();
    let count = lines.len() - 1;
    let values = sampled(&lines, (POINTS_PER_LINE * count).next_power_of_two());
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let factor = 2.0 * magnitude / (highest - lowest);
    lines.iter_mut().for_each(|line| *line *= factor);
    lines
}

/// Half the peak-to-peak value of a signal.
fn half_span(lines: &[Complex]) -> f64 {
    let values = sampled(lines, (POINTS_PER_LINE * lines.len()).next_power_of_two());
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    0.5 * (highest - values.iter().copied().fold(f64::INFINITY, f64::min))
}

/// Root mean square of a signal without its mean.
fn rms(lines: &[Complex]) -> f64 {
    (0.5 * lines.iter().skip(1).map(|line| line.norm_sqr()).sum::<f64>()).sqrt()
}

/// Σ Re Lₖ exp(jkωt) at `count` instants of the period.
fn sampled(lines: &[Complex], count: usize) -> Vec<f64> {
    let mut values = vec![Complex::new(0.0, 0.0); count];
    values.iter_mut().zip(lines).for_each(|(value, line)| *value = *line);
    FftPlanner::new().plan_fft_inverse(count).process(&mut values);
    values.iter().map(|value| value.re).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_multisine_has_lines_of_one_size_and_the_magnitude_that_is_asked_for() {
        let of_seed = |seed| multisine(20, 2.0, &mut ChaCha8Rng::seed_from_u64(seed));
        let lines = of_seed(1);
        let sizes: Vec<f64> = lines[1..].iter().map(|line| line.norm()).collect();
        assert_eq!((sizes.len(), lines[0].norm()), (20, 0.0));
        // Rounding of a few operations.
        assert!(sizes.iter().all(|size| (size / sizes[0] - 1.0).abs() < 1e-12));
        let finely = sampled(&lines, 1 << 14);
        let highest = finely.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lowest = finely.iter().copied().fold(f64::INFINITY, f64::min);
        // Between 16 points of a line its cosine falls by (π/16)²/2 = 2 % at most.
        let magnitude = 0.5 * (highest - lowest);
        assert!((2.0..2.04).contains(&magnitude), "{magnitude}");
        assert!((rms(&lines) / (10.0_f64.sqrt() * sizes[0]) - 1.0).abs() < 1e-12);
        assert_ne!(of_seed(2), lines);
    }
}
