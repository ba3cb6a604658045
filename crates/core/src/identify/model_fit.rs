//! A fitted model with its residuals, Jacobian and noise: everything needed to judge it.

use nalgebra::{DMatrix, DVector};

use crate::answers::{Comparison, Identification};
use crate::measurement::Measurement;
use crate::observer::Observer;

use super::fit_session::FitSession;
use super::noise_law::NoiseLaw;
use super::problem::Problem;
use super::request::{IdentifyError, IdentifyRequest};
use super::summary::Intervals;

/// One real number that was compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Component {
    /// Index of the experiment in the measurement.
    pub experiment: usize,
    /// Harmonic.
    pub order: usize,
    /// Whether it is the imaginary part.
    pub imaginary: bool,
    /// Whether it is not a datum but the fact that the mean velocity is 0.
    pub constraint: bool,
}

/// A model fitted to a measurement, and its linearisation there.
#[derive(Debug, Clone)]
pub struct ModelFit {
    /// The answer to an `identify` job.
    pub identification: Identification,
    /// Measured beside simulated.
    pub comparison: Comparison,
    /// What each row of `residuals` and `jacobian` is.
    pub components: Vec<Component>,
    /// (Y − Ŷ)/σ. Where the noise is unknown, σ is what is left per degree of freedom.
    pub residuals: DVector<f64>,
    /// ∂Ŷ/∂p/σ, one column for each parameter that no bound holds; p are
    /// logarithms and levels in scales of the data.
    pub jacobian: DMatrix<f64>,
    /// The law of the noise in `residuals`; where its size is unknown, up to a factor.
    pub noise: NoiseLaw,
    /// χ² per degree of freedom by the noise that the measurement states, where the fit weighs
    /// all harmonics alike instead and the model cannot come down to that noise.
    pub contradicts_noise: Option<f64>,
}

/// Fits the base model and keeps what a diagnosis needs of the fit.
///
/// # Errors
/// See [`IdentifyError`].
pub fn fit_base(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<ModelFit, IdentifyError> {
    let session = FitSession::new(measurement, request, observer)?;
    session.judge(session.base(), Intervals::Profile)
}

/// What each row of the residuals of a problem is.
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
        // Measured is above simulated there, by the 30 σ less what the fit took of it.
        assert!((15.0..30.0).contains(&fit.residuals[worst]), "{}", fit.residuals[worst]);
        // At a minimum the residual is orthogonal to every column.
        let slope = fit.jacobian.tr_mul(&fit.residuals);
        for (i, column) in fit.jacobian.column_iter().enumerate() {
            assert!(slope[i].abs() < 1e-5 * column.norm() * fit.residuals.norm());
        }
    }
}
