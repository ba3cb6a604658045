//! The refinement of a model by least squares, to the accuracy that is needed.

use super::{FitSession, Model};
use crate::identify::objective::Misfit;
use crate::identify::refine::{self, Patience};

/// How accurate a fit has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitAccuracy {
    /// A few steps, to choose among several starts and effects.
    Glance,
    /// Until χ² changes by far less than 1.
    Settle,
    /// Until no step matters any more: see `refine::THOROUGH`.
    Thorough,
}

impl FitSession<'_> {
    /// Fits all parameters of a model, starting at their current values. If the fit ends in a dead
    /// zone of an effect, it is repeated from outside of it, and the better fit is returned.
    pub fn refine(&self, model: &Model, effort: FitAccuracy) -> Model {
        self.refine_watched(model, effort, &|| ())
    }

    /// The same; `on_step` is called after every step of the fit.
    pub fn refine_watched(&self, model: &Model, effort: FitAccuracy, on_step: &dyn Fn()) -> Model {
        let descend = |from: &Model| self.descend(from, effort, on_step);
        self.escape(descend(model), descend)
    }

    /// If a fit ended in a dead zone of an effect, fits again from outside of it, and returns the
    /// better one.
    pub(super) fn escape(&self, refined: Model, descend: impl Fn(&Model) -> Model) -> Model {
        let Some(escaped) = refined.escaped() else { return refined };
        let again = descend(&escaped);
        let evaluations = again.evaluations;
        let best = if again.cost < refined.cost { again } else { refined };
        Model { evaluations, ..best }
    }

    pub(super) fn patience(&self, effort: FitAccuracy) -> Patience {
        let negligible = if self.noise_known() { self.data() as f64 } else { self.rounding() };
        let search = self.search();
        let (steps, cost_tolerance) = match effort {
            FitAccuracy::Glance => (search.glance_steps, search.trial_tolerance),
            FitAccuracy::Settle => (refine::THOROUGH.steps, search.settle_tolerance),
            FitAccuracy::Thorough => return refine::THOROUGH,
        };
        Patience { steps, cost_tolerance, negligible, ..refine::THOROUGH }
    }

    /// Fits a model by this misfit. Each simulation starts from the motion of the one before, unless
    /// only motions from rest count.
    pub(super) fn descend_by(
        &self,
        misfit: &Misfit<'_>,
        model: &Model,
        patience: Patience,
        on_step: &dyn Fn(),
    ) -> Model {
        let motions = misfit.new_motions();
        let misfit = Misfit { motions: motions.as_deref(), ..*misfit };
        model.refined(refine::refine(&misfit, &model.point, patience, &mut |_, _, _| on_step()))
    }
}
