//! A fitted model with its residuals, Jacobian and noise: all that a diagnosis needs to judge it.

use nalgebra::{DMatrix, DVector};

use crate::answers::{Comparison, Identification};
use crate::measurement::Measurement;
use crate::observer::Observer;

use super::fit_session::FitSession;
use super::noise_law::NoiseLaw;
use super::problem::Problem;
use super::request::{IdentifyError, IdentifyRequest};
use super::summary::Intervals;

/// One real number that is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Component {
    /// Index of the experiment in the measurement.
    pub experiment: usize,
    /// Harmonic.
    pub order: usize,
    /// Whether it is the imaginary part.
    pub imaginary: bool,
    /// Whether it is not a datum but the constraint of the mean velocity of a position.
    pub constraint: bool,
}

/// A model fitted to a measurement, and its linearisation there.
#[derive(Debug, Clone)]
pub struct ModelFit {
    /// The answer to an `identify` job.
    pub identification: Identification,
    /// The measured and the simulated responses.
    pub comparison: Comparison,
    /// What each row of `residuals` and `jacobian` stands for.
    pub components: Vec<Component>,
    /// (Y − Ŷ)/σ. If the noise is unknown, σ² is the sum of squares per degree of freedom.
    pub residuals: DVector<f64>,
    /// (∂Ŷ/∂p)/σ, one column for each parameter that is not held at a bound; p are logarithms or
    /// levels in the problem's units.
    pub jacobian: DMatrix<f64>,
    /// Directions along which nothing is left of the noise in `residuals`, nor of `jacobian`, one unit
    /// vector each: those of jumps that are estimated with the model.
    pub eliminated: DMatrix<f64>,
    /// The distribution of the noise in `residuals`; up to a factor if its size is unknown.
    pub noise: NoiseLaw,
    /// χ² per degree of freedom with the noise that the measurement states, if the fit weights all
    /// harmonics alike instead and the model cannot come down to that noise; else `None`.
    pub contradicts_noise: Option<f64>,
}

/// Fits the base model and keeps what a diagnosis needs of the fit.
pub fn fit_base(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<ModelFit, IdentifyError> {
    let measurement = measurement.repeated();
    let session = FitSession::new(&measurement, request, observer)?;
    session.judge(session.base(), Intervals::Profile)
}

/// What each row of the residuals of a problem stands for.
pub(super) fn components(problem: &Problem) -> Vec<Component> {
    let mut components = Vec::with_capacity(problem.data());
    for (experiment, prepared) in problem.experiments.iter().enumerate() {
        for target in &prepared.targets {
            let (order, constraint) = (target.order, target.constraint);
            let component = |imaginary| Component { experiment, order, imaginary, constraint };
            components.push(component(false));
            if !target.real {
                components.push(component(true));
            }
        }
    }
    components
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, joined, stepped_sine};
    use super::*;
    use crate::observer::Silent;

    #[test]
    fn residuals_jacobian_and_components_are_of_the_same_rows() {
        let mut experiments = stepped_sine(&axis(ACTUATORS[0]), 3).experiments().to_vec();
        for experiment in &mut experiments {
            experiment.response.iter_mut().for_each(|h| h.std = Some(0.01));
        }
        experiments[5].response[1].value.im += 0.3;
        let request = IdentifyRequest::default();
        let fit = fit_base(&joined(experiments), &request, &Silent).unwrap();
        assert_eq!(fit.residuals.len(), fit.components.len());
        assert_eq!(fit.jacobian.nrows(), fit.components.len());
        let worst = fit.residuals.iamax();
        let wanted = Component { experiment: 5, order: 1, imaginary: true, constraint: false };
        assert_eq!(fit.components[worst], wanted);
        // The measured value lies above the simulated one, by 30 σ less what the fit has absorbed.
        assert!((15.0..30.0).contains(&fit.residuals[worst]), "{}", fit.residuals[worst]);
        // At a minimum the residuals are orthogonal to every column.
        let slope = fit.jacobian.tr_mul(&fit.residuals);
        for (i, column) in fit.jacobian.column_iter().enumerate() {
            assert!(slope[i].abs() < 1e-5 * column.norm() * fit.residuals.norm());
        }
    }
}
