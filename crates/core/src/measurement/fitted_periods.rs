//! Fourier coefficients of periods that are no whole number of samples, by linear least squares.
//!
//! Samples x(n) of one period are fitted by Σ c(k)·exp(jkθn), |k| ≤ K, with θ = 2π/P for a period of P
//! samples. The normal equations Σ g(l − k)·c(l) = Σ x(n)·exp(−jkθn) have the geometric sums
//! g(d) = Σ exp(jdθn). Both sides are convolutions, so that a period of W samples costs a few Fourier
//! transforms, whatever K:
//!
//! * The right side is the chirp transform, with kn = ½·[k² + n² − (k − n)²] (L. I. Bluestein, IEEE
//!   Trans. Audio Electroacoust. 18, 1970).
//! * The matrix is that of a whole period but for the piece by which W differs from P. It is nearly W
//!   times the identity, with a few other eigenvalues, and conjugate gradients end after about six
//!   products with it.

use nalgebra::DVector;

use super::Complex;
use super::convolution::Convolution;
use super::spectrum::Periods;

/// Highest harmonic that is fitted. Excitations whose period is not a whole number of samples are
/// usually sines, and their response disappears in the noise well below it.
const MOST_HARMONICS: usize = 400;

/// Frequency of the highest fitted harmonic as a share of the sampling frequency. Closer to one
/// half, the fit amplifies noise.
const HIGHEST_SHARE: f64 = 0.4;

/// Size of the residual of the normal equations, as a share of their right side, at which they are
/// solved.
const SOLVED: f64 = 1e-15;

/// Most products with the matrix.
const MOST_PRODUCTS: usize = 100;

/// The fit of one period.
struct Fit {
    /// Samples of a period.
    samples: f64,
    /// Whole samples that are fitted.
    window: usize,
    /// Highest harmonic K.
    highest: usize,
    /// exp(−jθm²/2).
    chirp: Vec<Complex>,
    /// With exp(jθd²/2), d from −(W − 1) to K.
    by_chirp: Convolution,
    /// With g(−d), d from −2K to 2K.
    by_matrix: Convolution,
}

/// Coefficients Xₖ, k = 0 … K, for each of the last periods of a signal, as
/// [`spectrum::of_periods`](super::spectrum::of_periods).
pub(super) fn of_periods(signal: &[f64], periods: Periods) -> Vec<Vec<Complex>> {
    let fit = Fit::new(periods.samples);
    let step = std::f64::consts::TAU / periods.samples;
    let begin = signal.len() as f64 - periods.count as f64 * periods.samples;
    (0..periods.count)
        .map(|index| {
            let exact = (begin + index as f64 * periods.samples).max(0.0);
            // Rounding down keeps the last window inside the signal.
            let start = (exact.floor() as usize).min(signal.len() - fit.window);
            let mut lines = fit.lines(&signal[start..start + fit.window]);
            let offset = step * (start as f64 - begin);
            for (k, line) in lines.iter_mut().enumerate() {
                *line *= Complex::from_polar(1.0, -(k as f64) * offset);
            }
            lines
        })
        .collect()
}

impl Fit {
    fn new(samples: f64) -> Self {
        let highest = ((HIGHEST_SHARE * samples) as usize).clamp(1, MOST_HARMONICS);
        let window = samples.ceil() as usize;
        // The remainder keeps the angle exact where the square is large.
        let angle = |m: usize| {
            let square = m as f64 * m as f64;
            std::f64::consts::PI * (square % (2.0 * samples)) / samples
        };
        let chirp: Vec<Complex> =
            (0..window.max(highest + 1)).map(|m| Complex::from_polar(1.0, -angle(m))).collect();
        let turned = |d: usize| chirp[d].conj();
        let step = std::f64::consts::TAU / samples;
        let sum = |d: usize| geometric_sum(window, d as f64 * step);
        Self {
            samples,
            window,
            highest,
            by_chirp: Convolution::with(highest + 1, window, turned, turned),
            by_matrix: Convolution::with(2 * highest + 1, 2 * highest + 1, |d| sum(d).conj(), sum),
            chirp,
        }
    }

    /// Coefficients Xₖ of samples of one period, the first at t = 0.
    fn lines(&self, samples: &[f64]) -> Vec<Complex> {
        let mut solved = self.solved(&self.moments(samples));
        let lines = solved.as_mut_slice();
        lines[self.highest].im = 0.0;
        // A line and its mirror image at −k together make the real wave.
        lines[self.highest + 1..].iter_mut().for_each(|line| *line *= 2.0);
        lines[self.highest..].to_vec()
    }

    /// Σ x(n)·exp(−jkθn) for k = −K … K.
    fn moments(&self, samples: &[f64]) -> DVector<Complex> {
        let turned = samples.iter().zip(&self.chirp).map(|(x, turn)| turn * *x);
        let convolved = self.by_chirp.apply(turned);
        let above = |k: usize| convolved[k] * self.chirp[k];
        DVector::from_fn(2 * self.highest + 1, |row, _| match row.checked_sub(self.highest) {
            Some(k) => above(k),
            None => above(self.highest - row).conj(),
        })
    }

    /// Solves the normal equations by conjugate gradients.
    fn solved(&self, moments: &DVector<Complex>) -> DVector<Complex> {
        let product = |vector: &DVector<Complex>| {
            let convolved = self.by_matrix.apply(vector.iter().copied());
            DVector::from_column_slice(&convolved[..vector.len()])
        };
        let mut solved = moments / Complex::from(self.samples);
        let mut residual = moments - product(&solved);
        let mut direction = residual.clone();
        let mut size = residual.norm_squared();
        let enough = SOLVED * SOLVED * moments.norm_squared();
        for _ in 0..MOST_PRODUCTS {
            if size <= enough {
                break;
            }
            let image = product(&direction);
            let length = Complex::from(size / direction.dotc(&image).re);
            solved.axpy(length, &direction, Complex::ONE);
            residual.axpy(-length, &image, Complex::ONE);
            let before = std::mem::replace(&mut size, residual.norm_squared());
            direction = &residual + direction * Complex::from(size / before);
        }
        solved
    }
}

/// Σ exp(jnα), n = 0 … count − 1.
fn geometric_sum(count: usize, alpha: f64) -> Complex {
    let half = 0.5 * alpha;
    let size = match half == 0.0 {
        true => count as f64,
        false => (half * count as f64).sin() / half.sin(),
    };
    Complex::from_polar(1.0, half * (count as f64 - 1.0)) * size
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// Samples that no wave of the fit explains.
    fn rough(count: usize) -> Vec<f64> {
        (0..count).map(|n| (n as f64 * n as f64 * 0.7).sin() + 0.3).collect()
    }

    #[test]
    fn the_fit_is_that_of_least_squares() {
        for samples in [4.5, 5.0001, 12.5, 37.999, 62.37, 150.01] {
            let fit = Fit::new(samples);
            let values = rough(fit.window);
            let (step, highest) = (std::f64::consts::TAU / samples, fit.highest);
            let waves = DMatrix::from_fn(fit.window, 2 * highest + 1, |n, column| {
                let angle = step * n as f64 * column.div_ceil(2) as f64;
                if column % 2 == 1 {
                    angle.cos()
                } else if column == 0 {
                    1.0
                } else {
                    -angle.sin()
                }
            });
            let squares = waves.clone().svd(true, true);
            let expected = squares.solve(&DVector::from_column_slice(&values), 1e-12).unwrap();
            for (k, line) in fit.lines(&values).iter().enumerate() {
                let [re, im] = match k {
                    0 => [expected[0], 0.0],
                    k => [expected[2 * k - 1], expected[2 * k]],
                };
                // Rounding errors times the condition number, below 100.
                assert!((line - Complex::new(re, im)).norm() < 1e-12, "{samples} {k} {line}");
            }
        }
    }

    #[test]
    fn a_period_of_a_million_samples_has_exact_phases() {
        let samples = 1_000_000.37;
        let fit = Fit::new(samples);
        let step = std::f64::consts::TAU / samples;
        let wave: Vec<f64> = (0..fit.window).map(|n| (399.0 * step * n as f64).sin()).collect();
        let lines = fit.lines(&wave);
        assert!((lines[399] - Complex::new(0.0, -1.0)).norm() < 1e-10, "{}", lines[399]);
        assert!(lines[398].norm() < 1e-10, "{}", lines[398]);
    }
}
