//! Tests whether a model fitted with equal weights comes down to the noise that the measurement
//! states.

use crate::answers::{IdentifyOptions, Weighting};

use super::{FitSession, Model};
use crate::identify::noise;
use crate::identify::noise::Beside;
use crate::identify::objective::Misfit;
use crate::identify::refine;
use crate::identify::refine::Patience;

/// Above this χ² per degree of freedom no refit is tried (tuned): the residuals are more than four
/// times the noise, and other weights would not bring them down to it.
const LARGEST_REFITTED_CHI2: f64 = 20.0;

/// Most steps of the refit with the weights of the noise, which starts from the fit with equal
/// weights (tuned).
const MOST_STEPS: usize = 5;

impl FitSession<'_> {
    /// χ² per degree of freedom of a model, refitted with the noise that the measurement states, if
    /// the fit ignored that noise and χ² exceeds its mean by more than four standard deviations.
    /// `None` if the fit used the noise, if none is stated, or if nothing contradicts it.
    pub(super) fn contradicted_noise(&self, model: &Model, dof: i64) -> Option<f64> {
        let options = self.request.options;
        if options.weights == Weighting::Noise || dof <= 0 {
            return None;
        }
        let options = IdentifyOptions { weights: Weighting::Noise, ..options };
        let plant = model.coordinates.plant(&model.point);
        let beside = Beside { plant: &plant, effects: &[] };
        let weights = noise::weights(self.measurement, &self.problem, &options, Some(beside));
        if !weights.known() {
            return None;
        }
        let misfit = Misfit { weights: &weights, ..self.misfit(model) };
        let (dof, most) = (dof as f64, dof as f64 + 4.0 * (2.0 * dof as f64).sqrt());
        let here = misfit.cost(&model.point);
        let least = if here > most && here <= LARGEST_REFITTED_CHI2 * dof {
            let patience = Patience { steps: MOST_STEPS, ..refine::THOROUGH };
            refine::refine(&misfit, &model.point, patience, &mut |_, _, _| ()).cost
        } else {
            here
        };
        (least > most).then_some(least / dof)
    }
}
