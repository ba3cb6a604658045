//! Fourier coefficients of whole periods, by FFT or, if a period is not a whole number of samples,
//! by linear least squares.

use rustfft::FftPlanner;

use super::{Complex, fitted_periods};

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
        fitted_periods::of_periods(signal, periods)
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
