//! Convolution by Fourier transforms.

use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use super::Complex;

/// The convolution with one kernel.
pub(super) struct Convolution {
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    /// The transformed kernel, divided by its length.
    kernel: Vec<Complex>,
}

impl Convolution {
    /// For the first `outputs` values of y(k) = Σ h(k − n)·x(n) of at most `inputs` values x, with
    /// h(d) = `ahead(d)` and h(−d) = `behind(d)`, d ≥ 0.
    pub(super) fn with(
        outputs: usize,
        inputs: usize,
        ahead: impl Fn(usize) -> Complex,
        behind: impl Fn(usize) -> Complex,
    ) -> Self {
        let length = (outputs + inputs).next_power_of_two();
        let mut kernel = vec![Complex::ZERO; length];
        for (d, value) in kernel[..outputs].iter_mut().enumerate() {
            *value = ahead(d) / length as f64;
        }
        for d in 1..inputs {
            kernel[length - d] = behind(d) / length as f64;
        }
        let mut planner = FftPlanner::new();
        let forward = planner.plan_fft_forward(length);
        forward.process(&mut kernel);
        Self { forward, inverse: planner.plan_fft_inverse(length), kernel }
    }

    /// The values y; those beyond the first `outputs` mean nothing.
    pub(super) fn apply(&self, values: impl Iterator<Item = Complex>) -> Vec<Complex> {
        let mut buffer = Vec::with_capacity(self.kernel.len());
        buffer.extend(values);
        buffer.resize(self.kernel.len(), Complex::ZERO);
        self.forward.process(&mut buffer);
        buffer.iter_mut().zip(&self.kernel).for_each(|(value, factor)| *value *= factor);
        self.inverse.process(&mut buffer);
        buffer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_sum_over_all_inputs() {
        let h = |d: i32| Complex::new(f64::from(d * d - 3), f64::from(d));
        let of = |d: usize| i32::try_from(d).unwrap();
        for (outputs, inputs) in [(1, 1), (3, 5), (5, 3), (8, 8)] {
            let convolution = Convolution::with(outputs, inputs, |d| h(of(d)), |d| h(-of(d)));
            let values: Vec<Complex> =
                (0..inputs).map(|n| Complex::new(1.0 + n as f64, -0.5)).collect();
            let found = convolution.apply(values.iter().copied());
            for (k, found) in found[..outputs].iter().enumerate() {
                let expected: Complex =
                    values.iter().enumerate().map(|(n, x)| h(of(k) - of(n)) * x).sum();
                assert!((found - expected).norm() < 1e-12, "{outputs} {inputs} {k}");
            }
        }
    }
}
