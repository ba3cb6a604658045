//! A sum of squares, and its linearisation at a point.

use nalgebra::{DMatrix, DVector};

/// Residuals and their Jacobian.
#[derive(Debug, Clone)]
pub(in super::super) struct Linearisation {
    /// Residuals; of a misfit (Ŷ − Y)/σ: real and imaginary part of each datum in turn, harmonic 0
    /// with its real part alone.
    pub residuals: DVector<f64>,
    /// One row for each residual, one column for each coordinate.
    pub jacobian: DMatrix<f64>,
}

/// A sum of squares to be minimised. Its coordinates are scaled so that 1 is the longest sensible
/// step.
pub(in super::super) trait LeastSquares {
    /// Why a point has no residuals.
    type Error;

    /// Residuals at a point.
    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, Self::Error>;

    /// Residuals and their derivatives at a point.
    fn linearise(&self, point: &[f64]) -> Result<Linearisation, Self::Error>;

    /// Lower and upper bound of a coordinate.
    fn bounds(&self, _coordinate: usize) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Moves a point onto the bounds it exceeds.
    fn clamp(&self, point: &mut [f64]) {
        for (i, value) in point.iter_mut().enumerate() {
            let [least, most] = self.bounds(i);
            *value = value.clamp(least, most);
        }
    }

    /// Whether to stop before the next step.
    fn cancelled(&self) -> bool {
        false
    }
}
