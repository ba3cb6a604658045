//! Fills in samples of periods by what all others say of them.
//!
//! A sample is replaced by its conditional mean given all others of its period, as of a periodic
//! Gaussian process: with Xₖ the lines of the period and Sₖ their mean square, the filled samples
//! minimise Σ|Xₖ|²/Sₖ. The spectrum S is estimated from the filled periods, again and again.
//! (A. Janssen, R. Veldhuis, L. Vries, IEEE Trans. Acoust. Speech Signal Process. 34, 1986,
//! doi:10.1109/TASSP.1986.1164824, with lines in place of an autoregressive model.)

use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use crate::measurement::Complex;

/// Number of times that the spectrum is estimated.
const ROUNDS: usize = 8;

/// The smallest mean square of a line, over the largest. With less, conjugate gradients do not end.
const SMALLEST_POWER: f64 = 1e-10;

/// Residual of the equations, as a share of their right side, at which they are solved; and most
/// products with their matrix.
const SOLVED: f64 = 1e-8;
const MOST_PRODUCTS: usize = 300;

/// Fourier transforms of a period.
pub(super) struct Fill {
    forward: Arc<dyn Fft<f64>>,
    back: Arc<dyn Fft<f64>>,
}

impl Fill {
    /// For periods of so many samples.
    pub fn of(length: usize) -> Self {
        let mut planner = FftPlanner::new();
        let (forward, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        Self { forward, back }
    }

    /// Fills in the samples of each period that were cut off.
    pub fn fill(&self, periods: &mut [f64], cut: &[Vec<usize>]) {
        for _ in 0..ROUNDS {
            let inverse_power = self.inverse_power(periods);
            for (period, cut) in periods.chunks_exact_mut(self.forward.len()).zip(cut) {
                self.solve(period, cut, &inverse_power);
            }
        }
    }

    /// 1/Sₖ of every line, up to a factor: the mean over the periods, and half the median of the lines
    /// beyond half the Nyquist frequency, which are noise.
    fn inverse_power(&self, periods: &[f64]) -> Vec<f64> {
        let length = self.forward.len();
        let mut power = vec![0.0; length];
        for period in periods.chunks_exact(length) {
            let mut lines: Vec<Complex> = period.iter().map(|x| Complex::from(*x)).collect();
            self.forward.process(&mut lines);
            power.iter_mut().zip(&lines).for_each(|(power, line)| *power += line.norm_sqr());
        }
        let mut fast = power[length / 4..=length / 2].to_vec();
        let middle = fast.len() / 2;
        let noise = 0.5 * *fast.select_nth_unstable_by(middle, f64::total_cmp).1;
        let largest = power.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let least = noise.max(SMALLEST_POWER * largest);
        power.into_iter().map(|power| largest / (power + least)).collect()
    }

    /// The samples of a period that minimise Σ|Xₖ|²/Sₖ, by conjugate gradients.
    fn solve(&self, period: &mut [f64], cut: &[usize], inverse_power: &[f64]) {
        if cut.is_empty() {
            return;
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        // Half the gradient of Σ|Xₖ|²/Sₖ at the samples that were cut off.
        let mut residual = self.weighted(period, inverse_power, cut);
        residual.iter_mut().for_each(|value| *value = -*value);
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        let solved = SOLVED * SOLVED * square;
        let mut moved = vec![0.0; period.len()];
        for _ in 0..MOST_PRODUCTS {
            if square <= solved {
                break;
            }
            cut.iter().zip(&direction).for_each(|(at, value)| moved[*at] = *value);
            let product = self.weighted(&moved, inverse_power, cut);
            let step = square / dot(&direction, &product);
            cut.iter().zip(&direction).for_each(|(at, value)| period[*at] += step * value);
            residual.iter_mut().zip(&product).for_each(|(rest, value)| *rest -= step * value);
            let before = std::mem::replace(&mut square, dot(&residual, &residual));
            let ratio = square / before;
            let next = direction.iter_mut().zip(&residual);
            next.for_each(|(direction, rest)| *direction = rest + ratio * *direction);
        }
    }

    /// Samples weighted line by line, at some places.
    fn weighted(&self, samples: &[f64], weights: &[f64], places: &[usize]) -> Vec<f64> {
        let mut lines: Vec<Complex> = samples.iter().map(|x| Complex::from(*x)).collect();
        self.forward.process(&mut lines);
        lines.iter_mut().zip(weights).for_each(|(line, weight)| *line *= *weight);
        self.back.process(&mut lines);
        let scale = 1.0 / samples.len() as f64;
        places.iter().map(|at| scale * lines[*at].re).collect()
    }
}
