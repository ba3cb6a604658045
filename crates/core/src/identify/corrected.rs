//! A misfit on a coarse problem, corrected to first order.
//!
//! At one point, residuals and derivatives are made those of the fine problem by adding the differences
//! there (first-order model management: N. M. Alexandrov, R. M. Lewis and others 2001,
//! doi:10.2514/2.2877). Near that point a fit or a profile on the coarse problem then ends where one on the
//! fine problem does, and its simulations cost a fraction.

use nalgebra::DVector;

use super::levenberg_marquardt::{LeastSquares, Linearisation};
use super::objective::{Misfit, NoResiduals};

/// What a coarse problem lacks near a point, to first order.
pub(super) struct Correction {
    point: DVector<f64>,
    /// Fine less coarse residuals at the point, and their derivatives.
    lacking: Linearisation,
}

impl Correction {
    /// That of a coarse misfit at a point with this linearisation of the fine one; `None` if the coarse
    /// one has no response there.
    pub fn of(coarse: &Misfit<'_>, point: &[f64], fine: &Linearisation) -> Option<Self> {
        let mut lacking = coarse.linearise(point).ok()?;
        lacking.residuals = &fine.residuals - lacking.residuals;
        lacking.jacobian = &fine.jacobian - lacking.jacobian;
        Some(Self { point: DVector::from_column_slice(point), lacking })
    }
}

/// A misfit, with what it lacks near a point.
#[derive(Clone, Copy)]
pub(super) struct Corrected<'a> {
    /// The misfit.
    pub misfit: Misfit<'a>,
    /// What it lacks; nothing without.
    pub correction: Option<&'a Correction>,
}

impl Corrected<'_> {
    /// Sum of squared residuals; infinite where there is no response.
    pub fn cost(&self, point: &[f64]) -> f64 {
        self.residuals(point).map_or(f64::INFINITY, |residuals| residuals.norm_squared())
    }
}

impl LeastSquares for Corrected<'_> {
    type Error = NoResiduals;

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResiduals> {
        let mut residuals = self.misfit.residuals(point)?;
        if let Some(Correction { point: begin, lacking }) = self.correction {
            residuals += &lacking.residuals;
            residuals += &lacking.jacobian * (DVector::from_column_slice(point) - begin);
        }
        Ok(residuals)
    }

    fn linearise(&self, point: &[f64]) -> Result<Linearisation, NoResiduals> {
        let mut here = self.misfit.linearise(point)?;
        if let Some(Correction { point: begin, lacking }) = self.correction {
            here.residuals += &lacking.residuals;
            here.residuals += &lacking.jacobian * (DVector::from_column_slice(point) - begin);
            here.jacobian += &lacking.jacobian;
        }
        Ok(here)
    }

    fn bounds(&self, coordinate: usize) -> [f64; 2] {
        self.misfit.bounds(coordinate)
    }

    fn clamp(&self, point: &mut [f64]) {
        self.misfit.clamp(point);
    }

    fn cancelled(&self) -> bool {
        self.misfit.cancelled()
    }
}
