//! Estimates inputs that are not known along some directions, such as samples that were cut off.
//!
//! The response of the base model to each direction, with the shifts of its switching times, is
//! eliminated from the residuals of every model ([`super::eliminated`]). It is exact to first order, so
//! the input is moved to where it fits best, and the response taken again there: Gauss-Newton steps, with
//! the standard deviation of each direction as its prior.

use nalgebra::{DMatrix, DVector};

use crate::effects::ActiveEffect;
use crate::measurement::Complex;
use crate::plant::Plant;
use crate::simulate::{self, Excitation, NoResponse};

use super::eliminated::in_rows;
use super::noise::Weights;
use super::prediction;
use super::problem::{Prepared, Problem};

/// Number of times that the input is moved and the base model is fitted again.
pub(super) const ROUNDS: usize = 3;

impl Problem {
    /// Whether the input of any experiment with data was not estimated yet.
    pub fn lacks_inputs(&self) -> bool {
        let lacks = |experiment: &Prepared| {
            experiment.is_to_be_estimated() && experiment.unknown_input.columns.is_empty()
        };
        self.experiments.iter().any(lacks)
    }

    /// Moves every input that is not known to where the model fits best, and finds what its directions
    /// then add to the response.
    ///
    /// # Errors
    /// If the model has no response.
    pub fn estimate_inputs(
        &mut self,
        (plant, effects): (&Plant, &[ActiveEffect]),
        weights: &Weights,
    ) -> Result<(), NoResponse> {
        let is_unknown = |e: usize| self.experiments[e].is_to_be_estimated();
        for (e, predicted) in prediction::simulated(self, (plant, effects), is_unknown) {
            let experiment = &mut self.experiments[e];
            experiment.find_columns(plant)?;
            let steps = experiment.steps(&weights.sigma[e], &predicted?);
            experiment.move_input(&steps);
            experiment.find_columns(plant)?;
        }
        Ok(())
    }
}

impl Prepared {
    fn is_to_be_estimated(&self) -> bool {
        !self.targets.is_empty() && !self.unknown_input.directions.is_empty()
    }

    fn find_columns(&mut self, plant: &Plant) -> Result<(), NoResponse> {
        let Self { excitation, highest, targets, unknown_input, .. } = self;
        let known = excitation.input().len();
        let directions = unknown_input.directions.iter();
        let directions: Vec<&[Complex]> =
            directions.map(|lines| &lines[..lines.len().min(known)]).collect();
        let changes =
            simulate::respond_to_deviations(plant, &[], excitation, *highest, &directions)?;
        let of_targets = |velocity: &Vec<Complex>| {
            targets.iter().map(|target| velocity[target.order] * target.per_velocity).collect()
        };
        unknown_input.columns = changes.iter().map(of_targets).collect();
        Ok(())
    }

    /// How far the input is moved along each direction, in standard deviations: with the residuals r, their
    /// mean square s² and the columns A, Aᵀ·(A·Aᵀ + s²·I)⁻¹·r.
    fn steps(&self, sigma: &[f64], predicted: &[Complex]) -> DVector<f64> {
        let lacking = self.targets.iter().zip(predicted).map(|(t, predicted)| t.value - predicted);
        let lacking = in_rows(self, sigma, &lacking.collect::<Vec<_>>());
        let residuals = DVector::from_vec(lacking);
        let columns: Vec<DVector<f64>> = self
            .unknown_input
            .columns
            .iter()
            .map(|column| DVector::from_vec(in_rows(self, sigma, column)))
            .collect();
        let columns = DMatrix::from_columns(&columns);
        let variance = (residuals.norm_squared() / residuals.len() as f64).max(f64::MIN_POSITIVE);
        let rows = residuals.len();
        let sum = &columns * columns.transpose() + DMatrix::identity(rows, rows) * variance;
        match sum.cholesky() {
            Some(sum) => columns.tr_mul(&sum.solve(&residuals)),
            None => DVector::zeros(columns.ncols()),
        }
    }

    fn move_input(&mut self, steps: &DVector<f64>) {
        let before = &self.excitation;
        let mut input = before.input().to_vec();
        for (lines, step) in self.unknown_input.directions.iter().zip(steps) {
            input.iter_mut().zip(lines).for_each(|(line, own)| *line += own * *step);
        }
        self.excitation =
            Excitation::new(before.omega_rad_s(), input).at_run_share(before.run_share());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::identify::fixtures::{ACTUATORS, axis, joined, multisine};
    use crate::identify::noise::weights;
    use crate::identify::{FitSession, IdentifyRequest};
    use crate::measurement::Measurement;
    use crate::observer::Silent;

    /// Lines that are not known: the third, and the fifth by its imaginary part.
    fn directions() -> Vec<Vec<Complex>> {
        let along = |k: usize, value: Complex| {
            let mut lines = vec![Complex::ZERO; 31];
            lines[k] = value;
            lines
        };
        let [one, i] = [Complex::ONE, Complex::i()].map(|unit| 0.2 * unit);
        vec![along(3, one), along(3, i), along(5, i)]
    }

    /// A multisine of which these lines were read otherwise than they are.
    fn misread() -> (Measurement, Vec<Complex>) {
        let mut experiments = multisine(&axis(ACTUATORS[1])).experiments().to_vec();
        let truth = experiments[0].input.clone();
        experiments[0].input[3] += Complex::new(0.1, -0.05);
        experiments[0].input[5] += Complex::new(0.0, 0.15);
        experiments[0].unknown_input = directions();
        (joined(experiments), truth)
    }

    // The two simulators agree to 1e-5 of the response, and the lines are 0.6 large.
    #[test]
    fn an_input_that_is_not_known_is_moved_to_what_it_was() {
        let (measurement, truth) = misread();
        let mut problem = Problem::new(&measurement).unwrap();
        let plant = problem.in_scale(&axis(ACTUATORS[1]));
        for _ in 0..ROUNDS {
            let weights = weights(&measurement, &problem, &IdentifyOptions::default(), None);
            problem.estimate_inputs((&plant, &[]), &weights).unwrap();
        }
        let moved = problem.experiments[0].excitation.input();
        for k in [3, 5] {
            let off = (moved[k] * problem.scales.input - truth[k]).norm();
            assert!(off < 1e-3, "{k}: {off}");
        }
    }

    // The data are exact: what is left is the difference between the two simulators.
    #[test]
    fn what_is_not_known_is_estimated_with_the_base_model_and_takes_degrees_of_freedom() {
        let (measurement, _) = misread();
        let request = IdentifyRequest::default();
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let fit = session.judge(session.base(), crate::identify::Intervals::Curvature).unwrap();
        let fit = (fit.identification.fit, fit.jacobian.ncols());
        assert!(fit.0.nrmse < 1e-4, "{}", fit.0.nrmse);
        assert_eq!(fit.0.dof, (session.data() - fit.1 - directions().len()) as i64);
    }
}
