//! The judgement of a fitted model: all that is reported of it.

use super::{FitSession, Model};
use crate::answers::Stage;
use crate::identify::corrected::{Corrected, Correction};
use crate::identify::eliminated;
use crate::identify::model_fit::{self, ModelFit};
use crate::identify::objective::Evaluation;
use crate::identify::parameter_names;
use crate::identify::pipeline::Fitted;
use crate::identify::prediction::{self, Simulated};
use crate::identify::refine;
use crate::identify::request::{IdentifyError, no_response};
use crate::identify::solve::answer;
use crate::identify::summary::Intervals;
use crate::measurement::Complex;

impl FitSession<'_> {
    /// Everything needed to judge a fitted model. If it has no response from rest in some
    /// experiments, it is fitted again to the others and judged by them.
    ///
    /// # Errors
    /// When it has no response at all.
    pub fn judge(&self, model: &Model, intervals: Intervals) -> Result<ModelFit, IdentifyError> {
        match self.where_answered(model) {
            None => self.judge_whole(model, intervals),
            Some((rest, _)) if rest.data() == 0 => Err(no_response()),
            Some((rest, model)) => rest.judge_whole(&model, intervals),
        }
    }

    fn judge_whole(&self, model: &Model, intervals: Intervals) -> Result<ModelFit, IdentifyError> {
        let fitted = self.fitted(model);
        let weights = &fitted.weights;
        let misfit = self.misfit(model);
        let choice = self.order_choice.clone();
        let (measurement, request) = (self.measurement, self.request);
        let evaluation = misfit.evaluate(&model.point).map_err(|_| no_response())?;
        let point = (&fitted, &evaluation);
        let coarse = self.coarse.as_ref().filter(|_| intervals == Intervals::Profile);
        let coarse = coarse.map(|_| self.search_misfit(model));
        let correction =
            coarse.and_then(|coarse| Correction::of(&coarse, &model.point, &evaluation.here));
        let corrected = coarse
            .zip(correction.as_ref())
            .map(|(misfit, correction)| Corrected { misfit, correction: Some(correction) });
        let misfits = (&misfit, corrected);
        let mut identification = answer(measurement, misfits, request, point, choice, intervals);
        let Evaluation { predicted, here } = evaluation;
        let held = refine::held(&misfit, &model.point, &here);
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        if self.observer.cancelled() {
            return Err(IdentifyError::Cancelled);
        }
        let dof = identification.fit.dof;
        let simulated = self.simulated(model, predicted);
        let comparison =
            prediction::beside(self.measurement, (&self.problem, &[]), simulated, weights, dof);
        identification.fit.unanswered.clone_from(&comparison.unanswered);
        let sigma = match weights.known() {
            true => 1.0,
            false => (model.cost / dof.max(1) as f64).sqrt().max(f64::MIN_POSITIVE),
        };
        Ok(ModelFit {
            identification,
            comparison,
            components: model_fit::components(&self.problem),
            residuals: -here.residuals / sigma,
            jacobian: here.jacobian.select_columns(&free) / sigma,
            eliminated: eliminated::columns(&weights.eliminated, self.problem.data()),
            noise: self.noise(),
            contradicts_noise: self.contradicted_noise(model, dof),
        })
    }

    /// What a model predicts of each experiment. Those without data, in which it has no response, are
    /// simulated for the reason.
    fn simulated(&self, model: &Model, predicted: Vec<Vec<Complex>>) -> Simulated {
        let (plant, effects) =
            (model.coordinates.plant(&model.point), model.coordinates.effects_at(&model.point));
        let is_left_out = |e: usize| self.problem.experiments[e].targets.is_empty();
        let mut simulated = prediction::simulated(&self.problem, (&plant, &effects), is_left_out);
        let answered = predicted.into_iter().enumerate().filter(|(e, _)| !is_left_out(*e));
        simulated.extend(answered.map(|(e, values)| (e, Ok(values))));
        simulated.sort_by_key(|(e, _)| *e);
        simulated
    }

    fn fitted(&self, model: &Model) -> Fitted {
        let mut stages = self.fitted.stages.clone();
        if !model.effects().is_empty() {
            stages.push(Stage {
                name: "extension".into(),
                evaluations: model.evaluations,
                budget: None,
                seconds: 0.0,
                cost: model.cost,
                parameters: parameter_names::values(
                    &self.problem.in_units(&model.coordinates.plant(&model.point)),
                ),
                stop_reason: "converged".into(),
            });
        }
        Fitted {
            order: self.fitted.order,
            coordinates: model.coordinates.clone(),
            point: model.point.clone(),
            weights: self.fitted.weights.clone(),
            cost: model.cost,
            stages,
        }
    }
}
