//! Fourier coefficients of whole periods, by FFT or, if a period is not a whole number of samples,
//! by linear least squares.

use nalgebra::{DMatrix, DVector};
use rustfft::FftPlanner;

use super::Complex;

/// Highest harmonic fitted by least squares.
///
/// The cost of the fit grows with its third power. Excitations whose period is not a whole number
/// of samples are usually sines, and their response disappears in the noise well below it.
const MOST_FITTED_HARMONICS: usize = 400;

/// Frequency of the highest fitted harmonic as a share of the sampling frequency. Closer to one
/// half, the fit amplifies noise.
const HIGHEST_FITTED_SHARE: f64 = 0.4;

/// The periods of a record that are used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Periods {
    /// Length of one period, samples. An exact whole number selects the FFT.
    pub(super) samples: f64,
    /// Number of periods.
    pub(super) count: usize,
}

/// Coefficients Xₖ, k = 0 … K, of x(t) = Re Σ Xₖ exp(jkωt), for each of the last `periods.count`
/// periods of a signal; t = 0 is the beginning of the first of them.
///
/// If a period is a whole number of samples, by discrete Fourier transform up to the Nyquist
/// frequency; otherwise by least squares over each period.
pub(super) fn of_periods(signal: &[f64], periods: Periods) -> Vec<Vec<Complex>> {
    if periods.samples.fract() == 0.0 {
        transformed(signal, periods)
    } else {
        fitted(signal, periods)
    }
}

fn transformed(signal: &[f64], periods: Periods) -> Vec<Vec<Complex>> {
    let length = periods.samples as usize;
    let transform = FftPlanner::new().plan_fft_forward(length);
    let used = &signal[signal.len() - length * periods.count..];
    used.chunks_exact(length)
        .map(|period| {
            let mut buffer: Vec<Complex> = period.iter().map(|x| Complex::new(*x, 0.0)).collect();
            transform.process(&mut buffer);
            buffer.truncate(length / 2 + 1);
            for (k, value) in buffer.iter_mut().enumerate() {
                // All other lines share their amplitude with a mirror image at −k.
                let mirrored = k == 0 || 2 * k == length;
                *value *= if mirrored { 1.0 } else { 2.0 } / length as f64;
            }
            buffer
        })
        .collect()
}

fn fitted(signal: &[f64], periods: Periods) -> Vec<Vec<Complex>> {
    let highest =
        ((HIGHEST_FITTED_SHARE * periods.samples) as usize).clamp(1, MOST_FITTED_HARMONICS);
    let window = periods.samples.ceil() as usize;
    let step = std::f64::consts::TAU / periods.samples;
    let normal = normal_matrix(window, step, highest)
        .cholesky()
        .expect("a full period of samples, more than unknowns, determines them");
    let begin = signal.len() as f64 - periods.count as f64 * periods.samples;
    (0..periods.count)
        .map(|index| {
            let exact = (begin + index as f64 * periods.samples).max(0.0);
            // Rounding down keeps the last window inside the signal.
            let start = (exact.floor() as usize).min(signal.len() - window);
            let samples = &signal[start..start + window];
            let mut moments = DVector::zeros(2 * highest + 1);
            moments[0] = samples.iter().sum();
            for k in 1..=highest {
                let turn = Complex::from_polar(1.0, step * k as f64);
                let sum = samples.iter().rev().fold(Complex::ZERO, |sum, x| sum * turn + x);
                moments[2 * k - 1] = sum.re;
                moments[2 * k] = sum.im;
            }
            let solved = normal.solve(&moments);
            let offset = step * (start as f64 - begin);
            std::iter::once(Complex::new(solved[0], 0.0))
                .chain((1..=highest).map(|k| {
                    Complex::new(solved[2 * k - 1], -solved[2 * k])
                        * Complex::from_polar(1.0, -(k as f64) * offset)
                }))
                .collect()
        })
        .collect()
}

/// AᵀA for the columns 1, cos θ, sin θ, cos 2θ, sin 2θ … of A at `count` equal steps of the angle
/// θ, from the geometric sums of exp(jdθ).
fn normal_matrix(count: usize, step: f64, highest: usize) -> DMatrix<f64> {
    let sums: Vec<Complex> = (0..=2 * highest)
        .map(|d| {
            let half = 0.5 * d as f64 * step;
            let size =
                if half == 0.0 { count as f64 } else { (half * count as f64).sin() / half.sin() };
            Complex::from_polar(1.0, half * (count as f64 - 1.0)) * size
        })
        .collect();
    DMatrix::from_fn(2 * highest + 1, 2 * highest + 1, |row, column| {
        let (k, l) = (row.div_ceil(2), column.div_ceil(2));
        let total = sums[k + l];
        let difference = if k >= l { sums[k - l] } else { sums[l - k].conj() };
        match (row > 0 && row % 2 == 0, column > 0 && column % 2 == 0) {
            (false, false) => 0.5 * (difference.re + total.re),
            (true, true) => 0.5 * (difference.re - total.re),
            (true, false) => 0.5 * (total.im + difference.im),
            (false, true) => 0.5 * (total.im - difference.im),
        }
    })
}

/// Lines of an input that holds each sample until the next, from those of its samples: line k of N
/// samples a period is multiplied by sin(πk/N)/(πk/N)·exp(−jπk/N). The images of the lines beyond
/// the Nyquist frequency are left out.
pub(super) fn hold(lines: &mut [Complex], samples: f64) {
    for (k, line) in lines.iter_mut().enumerate().skip(1) {
        let half = std::f64::consts::PI * k as f64 / samples;
        *line *= Complex::from_polar(half.sin() / half, -half);
    }
}

/// Sum of the squared moduli of harmonics.
pub(super) fn power(harmonics: &[Complex]) -> f64 {
    harmonics.iter().map(Complex::norm_sqr).sum()
}

/// Mean over the periods, and the deviation of each period from it.
pub(super) fn mean_and_deviations(spectra: &[Vec<Complex>]) -> (Vec<Complex>, Vec<Vec<Complex>>) {
    let count = spectra.len() as f64;
    let mean: Vec<Complex> = (0..spectra[0].len())
        .map(|k| spectra.iter().map(|spectrum| spectrum[k]).sum::<Complex>() / count)
        .collect();
    let deviations = spectra
        .iter()
        .map(|spectrum| spectrum.iter().zip(&mean).map(|(value, mean)| value - mean).collect())
        .collect();
    (mean, deviations)
}

#[cfg(test)]
mod tests {
    use super::*;

    // The mean of exp(jkωt) over each interval, by 1000 midpoints: (2π·7/(16·1000))²/24 = 3e-7.
    #[test]
    fn a_held_line_is_the_mean_of_steps() {
        for k in [1_usize, 3, 7] {
            let mut lines = vec![Complex::ZERO; 9];
            lines[k] = Complex::ONE;
            hold(&mut lines, 16.0);
            let angle = |n: f64| std::f64::consts::TAU * k as f64 * n / 16.0;
            let at = |n: u32| {
                let held = Complex::from_polar(1.0, angle(f64::from(n / 1000)));
                held * Complex::from_polar(1.0, -angle((f64::from(n) + 0.5) / 1000.0))
            };
            let expected = (0..16_000).map(at).sum::<Complex>() / 16_000.0;
            assert!((lines[k] - expected).norm() < 1e-6, "{k}");
        }
    }

    fn harmonics() -> Vec<Complex> {
        vec![
            Complex::new(0.5, 0.0),
            Complex::new(1.0, -2.0),
            Complex::new(0.0, 0.3),
            Complex::ZERO,
            Complex::new(-0.1, 0.2),
        ]
    }

    fn signal(samples_per_period: f64, count: usize, start: f64) -> Vec<f64> {
        (0..count)
            .map(|n| {
                let angle = std::f64::consts::TAU * (n as f64 - start) / samples_per_period;
                harmonics()
                    .iter()
                    .enumerate()
                    .map(|(k, x)| (x * Complex::from_polar(1.0, k as f64 * angle)).re)
                    .sum()
            })
            .collect()
    }

    fn assert_recovered(samples: f64, length: usize, count: usize) {
        let begin = length as f64 - count as f64 * samples;
        let spectra = of_periods(&signal(samples, length, begin), Periods { samples, count });
        assert_eq!(spectra.len(), count);
        for spectrum in spectra {
            for (k, value) in spectrum.iter().enumerate() {
                let truth = harmonics().get(k).copied().unwrap_or(Complex::ZERO);
                // Rounding errors times the condition number of the fit (below 100).
                assert!((value - truth).norm() < 1e-11, "{samples} {k} {value} {truth}");
            }
        }
    }

    #[test]
    fn whole_periods_of_whole_samples_are_transformed_exactly() {
        assert_recovered(64.0, 64 * 3 + 17, 3);
        assert_recovered(63.0, 63 * 2, 2);
    }

    #[test]
    fn periods_between_samples_are_fitted_exactly() {
        assert_recovered(62.37, 500, 8);
        assert_recovered(12.5, 25, 2);
        assert_recovered(1234.56, 4000, 3);
    }
}
