//! Whether a model that was fitted with equal weights comes down to the noise that the
//! measurement states.

use crate::answers::{IdentifyOptions, Weighting};

use super::{FitSession, Model};
use crate::identify::noise;
use crate::identify::objective::Misfit;
use crate::identify::refine;
use crate::identify::refine::Patience;

/// χ² per degree of freedom beyond which other weights would not bring a model down to the noise:
/// what is left is more than four times as large.
const BEYOND_WEIGHTS: f64 = 20.0;

/// Steps with the weights of the noise, from where equal weights ended.
const STEPS: usize = 5;

impl FitSession<'_> {
    /// χ² per degree of freedom of a model by the noise that the measurement states, where the
    /// fit set that noise aside and χ² exceeds what noise makes it by more than four standard
    /// deviations, refitted with the weights of the noise; `None` where the noise was not set
    /// aside, none is stated, or nothing contradicts it.
    pub(super) fn contradicted_noise(&self, model: &Model, dof: i64) -> Option<f64> {
        let options = self.request.options;
        if options.weights == Weighting::Noise || dof <= 0 {
            return None;
        }
        let options = IdentifyOptions { weights: Weighting::Noise, ..options };
        let plant = model.coordinates.plant(&model.point);
        let weights = noise::weights(self.measurement, &self.problem, &options, Some(&plant));
        if !weights.known() {
            return None;
        }
        let misfit = Misfit { weights: &weights, ..self.misfit(model) };
        let (dof, most) = (dof as f64, dof as f64 + 4.0 * (2.0 * dof as f64).sqrt());
        let here = misfit.cost(&model.point);
        let least = if here > most && here <= BEYOND_WEIGHTS * dof {
            let patience = Patience { steps: STEPS, ..refine::THOROUGH };
            refine::refine(&misfit, &model.point, patience, &mut |_, _, _| ()).cost
        } else {
            here
        };
        (least > most).then_some(least / dof)
    }
}
