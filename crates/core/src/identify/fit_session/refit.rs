//! Refits without a part of the data.
//!
//! Without that part the linearisation of the fit to all data is that of its other rows. The refit
//! begins with it, so that its first step is the algebra of leaving a block out (`left_out`). Where
//! the model is nearly linear over the move, that step is all it takes. The ranges and units of the
//! parameters, and the deviations of the data, are those of all data.

use super::coarse::Coarse;
use super::left_out::LeavingOut;
use super::{FitAccuracy, FitSession, Model};
use crate::answers::Comparison;
use crate::identify::objective::Misfit;
use crate::identify::pipeline::Fitted;
use crate::identify::prediction;
use crate::identify::refine;
use crate::identify::refine::Patience;
use crate::identify::request::{IdentifyError, no_response, unless_cancelled};

/// A model counts as linear over the move of a refit if the cost falls by what the linearisation
/// predicts, to within this share (tuned).
const LINEAR_WITHIN: f64 = 0.05;

impl<'a> FitSession<'a> {
    /// A session without the data that are `held`, given their experiment and harmonic. Its base
    /// model is refitted; `base` is the linearised one of this session.
    ///
    /// # Errors
    /// When cancelled, or if the base model has no response.
    pub fn without(
        &self,
        held: impl Fn(usize, usize) -> bool,
        base: &LeavingOut,
    ) -> Result<Self, IdentifyError> {
        let mut rest = self.only(|e, order| !held(e, order));
        rest.base = rest.refit(base, held, &|| ());
        let predicted = rest.search_misfit(&rest.base).predict(&rest.base.point);
        let stand_in = unless_cancelled(self.observer, predicted.map_err(|_| no_response()))?;
        match &mut rest.coarse {
            Some(coarse) => coarse.stand_in = stand_in,
            None => rest.stand_in = stand_in,
        }
        Ok(rest)
    }

    /// Refits a model in a session without the data that are `held`; `model` is linearised in the
    /// session with all data. `on_step` is called after every step.
    pub fn refit(
        &self,
        model: &LeavingOut,
        held: impl Fn(usize, usize) -> bool,
        on_step: &dyn Fn(),
    ) -> Model {
        let LeavingOut { model: from, .. } = model;
        // A fit that stops sooner keeps some of what it knew of the part left out.
        let patience =
            Patience { linear_within: LINEAR_WITHIN, ..self.patience(FitAccuracy::Settle) };
        let here = model.only(|e, order| !held(e, order));
        let misfit = self.search_misfit(from);
        let motions = misfit.new_motions();
        let misfit = Misfit { motions: motions.as_deref(), ..misfit };
        let start = (from.point.clone(), here);
        let refined = refine::refine_from(&misfit, start, patience, &mut |_, _, _| on_step());
        let refitted = from.refined(refined);
        self.escape(refitted, |from| self.descend(from, FitAccuracy::Settle, on_step))
    }

    /// The same session with only the data that `keep` wants, given their experiment and harmonic.
    /// Nothing is fitted again.
    pub(super) fn only(&self, keep: impl Fn(usize, usize) -> bool) -> Self {
        let subset = self.problem.subset(|e, target| keep(e, target.order));
        let problem = self.problem.only(&subset);
        let weights = subset.weights(&self.fitted.weights, &problem);
        let coarse = self.coarse.as_ref().map(|coarse| Coarse {
            problem: coarse.problem.only(&subset),
            stand_in: subset.predictions(&coarse.stand_in),
        });
        Self {
            measurement: self.measurement,
            request: self.request,
            observer: self.observer,
            problem,
            fitted: Fitted { weights, ..self.fitted.clone() },
            order_choice: self.order_choice.clone(),
            orders: Vec::new(),
            base: self.base.clone(),
            stand_in: subset.predictions(&self.stand_in),
            coarse,
        }
    }

    /// Compares the measurement with a model, in the experiments that are `wanted`; as accurately as
    /// the fits of a search.
    pub fn compare(&self, model: &Model, wanted: impl Fn(usize) -> bool) -> Comparison {
        let law =
            (model.coordinates.plant(&model.point), model.coordinates.effects_at(&model.point));
        let dof = self.problem.data() as i64 - model.parameters() as i64;
        let weights = &self.fitted.weights;
        let (problem, corrections) = match &self.coarse {
            Some(coarse) => (&coarse.problem, self.corrections(coarse)),
            None => (&self.problem, Vec::new()),
        };
        let corrected = (problem, corrections.as_slice());
        let simulated = prediction::simulated(problem, (&law.0, &law.1), wanted);
        prediction::beside(self.measurement, corrected, simulated, weights, dof)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest, Weighting};
    use crate::effects::find;
    use crate::identify::fixtures::{axis, multisine, stepped_sine};
    use crate::identify::request::IdentifyRequest;
    use crate::measurement::Measurement;
    use crate::observer::Silent;
    use crate::plant::Actuator;

    fn request() -> IdentifyRequest {
        let mut options = IdentifyOptions::default();
        options.network.enabled = false;
        options.colony.enabled = false;
        // What the models lack is not noise, from which weights would follow.
        options.weights = Weighting::Response;
        let plant = Some(PlantRequest { actuator_order: 0 });
        IdentifyRequest { plant, options, ..IdentifyRequest::default() }
    }

    /// Responses of an axis with an actuator, which the models of these tests lack.
    fn measurements() -> [Measurement; 2] {
        let axis = axis(Actuator::FirstOrder { corner_rad_s: 60.0 });
        [stepped_sine(&axis, 3), multisine(&axis)]
    }

    // A refit from the fit to all data, refined thoroughly, has the least cost. The
    // tolerance is that of the refit.
    #[test]
    fn a_refit_ends_where_a_fit_to_the_rest_ends_and_takes_few_steps() {
        let request = request();
        for measurement in measurements() {
            let session = FitSession::new(&measurement, &request, &Silent).unwrap();
            // The highest frequencies, which show the actuator most.
            let held = |e: usize, order: usize| e % 8 >= 6 || order > 20;
            let base = session.leaving_out(session.base()).unwrap();
            let rest = session.without(held, &base).unwrap();
            let lag = session.extend(session.base(), find("sensor_lag").unwrap());
            let model = session.refine(&lag, FitAccuracy::Thorough);
            let left_out = session.leaving_out(&model).unwrap();
            for (refitted, from) in [
                (rest.base().clone(), session.base()),
                (rest.refit(&left_out, held, &|| ()), &model),
            ] {
                let best = rest.refine(from, FitAccuracy::Thorough);
                let excess = rest.cost(&refitted).unwrap() / best.cost - 1.0;
                assert!((-1e-9..1e-3).contains(&excess), "{excess}");
                let taken = refitted.evaluations - from.evaluations;
                assert!(taken <= 6, "{taken} evaluations");
            }
            let best = rest.refine(session.base(), FitAccuracy::Thorough);
            let staying = rest.cost(session.base()).unwrap() / best.cost - 1.0;
            assert!(staying > 1e-2, "leaving the part out changes little: {staying}");
        }
    }

    #[test]
    fn data_left_out_changes_nothing() {
        let request = request();
        let [measurement, _] = measurements();
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let held = |_, order: usize| order == 3;
        let base = session.leaving_out(session.base()).unwrap();
        let rest = session.without(held, &base).unwrap();
        let mut experiments = measurement.experiments().to_vec();
        for harmonic in experiments.iter_mut().flat_map(|e| &mut e.response) {
            harmonic.value *= if harmonic.order == 3 { 2.0 } else { 1.0 };
        }
        let changed = crate::identify::fixtures::joined(experiments);
        let other = FitSession::new(&changed, &request, &Silent).unwrap();
        let base = other.leaving_out(other.base()).unwrap();
        let again = other.without(held, &base).unwrap();
        assert_eq!(again.data(), rest.data());
        let [a, b] = [&rest, &again].map(|session| session.base());
        // Each is settled to 1e-5 in its last step.
        assert!((a.cost / b.cost - 1.0).abs() < 1e-3, "{} {}", a.cost, b.cost);
        let apart = a.point.iter().zip(&b.point).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let between = session.base().point.iter().zip(&other.base().point);
        let between = between.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.2 * between, "{apart} of {between}");
    }
}
