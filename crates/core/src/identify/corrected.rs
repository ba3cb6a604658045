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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::identify::fixtures::{ACTUATORS, axis, multisine};
    use crate::identify::noise;
    use crate::identify::parameters::Coordinates;
    use crate::identify::problem::Problem;
    use crate::observer::Silent;

    #[test]
    fn a_corrected_coarse_misfit_and_its_derivatives_are_those_of_the_fine_one_at_its_point() {
        let axis = axis(ACTUATORS[1]);
        let measurement = multisine(&axis);
        let problem = Problem::new(&measurement).unwrap();
        let coordinates = Coordinates::new(1, false, &problem.prior);
        let weights = noise::weights(&measurement, &problem, &IdentifyOptions::default(), None);
        let fine = Misfit::new(&problem, &coordinates, &weights, &Silent);
        let rough = problem.coarser(0.1).unwrap();
        let coarse = Misfit { problem: &rough, ..fine };
        let point = coordinates.point(&problem.in_scale(&axis));
        let here = fine.linearise(&point).unwrap();
        let correction = Correction::of(&coarse, &point, &here).unwrap();
        let corrected = Corrected { misfit: coarse, correction: Some(&correction) };
        let there = corrected.linearise(&point).unwrap();
        let alone = coarse.linearise(&point).unwrap();
        assert!((&alone.residuals - &here.residuals).norm() > 1e-9 * here.jacobian.norm());
        // Rounding.
        assert!((&there.residuals - &here.residuals).norm() < 1e-12 * here.jacobian.norm());
        assert!((&there.jacobian - &here.jacobian).norm() < 1e-12 * here.jacobian.norm());
    }
}
