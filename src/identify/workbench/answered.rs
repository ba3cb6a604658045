//! Models that have no response in some experiments.
//!
//! A search passes through places where the motion from rest does not settle to the period of
//! the input: an unstable motion of that period stands in there, or what the base model says
//! (`objective`). Nothing of that counts in the end. Among models, one is worth what the motions
//! reached from rest leave, and as much as the base model where there is none, so that an effect
//! gains nothing by having no response. An answer is fitted to what has a response, and judged
//! by it.

use crate::simulate::Counts;

use super::super::objective::Misfit;
use super::super::pipeline::Fitted;
use super::super::refine;
use super::{Effort, Model, Workbench};

impl Workbench<'_> {
    /// A fitted model as it counts among others: as it is where it has a response from rest in
    /// every experiment, and else fitted again, by the motions that are reached from rest. Its
    /// cost is infinite where too many experiments have none.
    pub fn from_rest(&self, model: Model) -> Model {
        if !model.cost.is_finite() || self.unanswered(&model).is_empty() {
            return model;
        }
        let misfit = Misfit { counts: Counts::FromRest, ..self.misfit(&model) };
        self.descend_by(&misfit, &model, self.patience(Effort::Settle))
    }

    /// Experiments in which a model has no response from rest.
    fn unanswered(&self, model: &Model) -> Vec<usize> {
        if model.effects().is_empty() {
            return Vec::new();
        }
        let misfit = Misfit { counts: Counts::FromRest, ..self.misfit(model) };
        misfit.unanswered(&model.point)
    }

    /// A model fitted to the experiments in which it has a response from rest, on a workbench of
    /// them alone; `None` where these are all.
    pub(super) fn where_answered(&self, model: &Model) -> Option<(Self, Model)> {
        let mut left_out = self.unanswered(model);
        if left_out.is_empty() {
            return None;
        }
        let mut model = model.clone();
        loop {
            let rest = self.without(&left_out);
            let weights = &rest.fitted.weights;
            let misfit = Misfit::new(&rest.problem, &model.coordinates, weights, self.observer);
            model = rest.descend_by(&misfit, &model, refine::THOROUGH);
            // Some may have a response where the fit has led to; those that had one still do.
            let still = self.unanswered(&model);
            if still.len() >= left_out.len() || self.observer.cancelled() {
                return Some((rest, model));
            }
            left_out = still;
        }
    }

    /// The same workbench with nothing measured in these experiments.
    fn without(&self, experiments: &[usize]) -> Self {
        let fitted = self.fitted.clone();
        Self {
            measurement: self.measurement,
            request: self.request,
            observer: self.observer,
            problem: self.problem.without(experiments),
            fitted: Fitted { weights: fitted.weights.without(experiments), ..fitted },
            order_choice: self.order_choice.clone(),
            base: self.base.clone(),
            stand_in: self.stand_in.clone(),
        }
    }
}
