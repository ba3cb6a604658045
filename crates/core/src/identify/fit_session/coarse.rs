//! A coarse problem on which a search looks for the best model.
//!
//! Records are simulated on a fine grid. On a coarser one a simulation takes half the time and less,
//! and errs by some 1e-5 of the response, which may be more than the noise. Nearly all of that error
//! is common to all models worth looking at. So the data of the coarse problem are shifted by the
//! error of the base model, the defect: the base model then has the same residuals on both. This is
//! the defect correction of space mapping with a shift of the output (Koziel, Cheng and Bandler
//! 2008, doi:10.1109/MMM.2008.929554).

use super::{FitAccuracy, FitSession, Model};
use crate::identify::objective::Misfit;
use crate::identify::problem::Problem;
use crate::identify::refine::Patience;
use crate::measurement::Complex;
use crate::simulate::Counts;

/// A fit on the coarse problem is repeated on the fine one if its cost is larger there by more than
/// this share (tuned).
const LARGEST_DISAGREEMENT: f64 = 0.01;

/// A problem with coarse simulations, and data to match.
pub(super) struct Coarse {
    problem: Problem,
    /// The responses of the base model on it.
    stand_in: Vec<Vec<Complex>>,
}

impl FitSession<'_> {
    /// The coarse problem; `None` where it would save nothing or the base model has no response on
    /// it.
    pub(super) fn coarsened(&self) -> Option<Coarse> {
        let mut problem = self.problem.coarse()?;
        let misfit = Misfit { problem: &problem, stand_in: None, ..self.misfit(&self.base) };
        let stand_in = misfit.predict(&self.base.point).ok()?;
        for (experiment, (coarse, fine)) in
            problem.experiments.iter_mut().zip(stand_in.iter().zip(&self.stand_in))
        {
            for (target, (coarse, fine)) in
                experiment.targets.iter_mut().zip(coarse.iter().zip(fine))
            {
                target.value += coarse - fine;
            }
        }
        Some(Coarse { problem, stand_in })
    }

    /// The misfit of a model while a search looks for the best one.
    pub(super) fn search_misfit<'m>(&'m self, model: &'m Model) -> Misfit<'m> {
        let misfit = self.misfit(model);
        match &self.coarse {
            Some(Coarse { problem, stand_in }) => {
                Misfit { problem, stand_in: Some(stand_in), ..misfit }
            }
            None => misfit,
        }
    }

    /// Fits a model: on the coarse problem alone if the fit is short; else it begins there and ends
    /// on the fine one. A thorough fit starts near its end, and stays on the fine one.
    pub(super) fn descend(&self, model: &Model, effort: FitAccuracy, on_step: &dyn Fn()) -> Model {
        let patience = self.patience(effort);
        if effort == FitAccuracy::Thorough || self.coarse.is_none() {
            return self.descend_by(&self.misfit(model), model, patience, on_step).0;
        }
        let (begun, damping) =
            self.descend_by(&self.search_misfit(model), model, patience, on_step);
        if effort != FitAccuracy::Settle || !begun.cost.is_finite() {
            return begun;
        }
        let patience = Patience { damping, ..patience };
        self.descend_by(&self.misfit(&begun), &begun, patience, on_step).0
    }

    /// A model as it counts on the fine problem, with only motions from rest as responses; it is
    /// fitted there if the coarse problem, on which it may have been fitted, disagrees. `None` if
    /// it has no such response in some experiment.
    pub(super) fn counted(&self, model: &Model) -> Option<Model> {
        let misfit = Misfit { stand_in: None, counts: Counts::FromRest, ..self.misfit(model) };
        let cost = misfit.cost(&model.point);
        if !cost.is_finite() {
            return None;
        }
        if cost <= (1.0 + LARGEST_DISAGREEMENT) * model.cost {
            return Some(Model { cost, ..model.clone() });
        }
        let (fitted, _) =
            self.descend_by(&misfit, model, self.patience(FitAccuracy::Settle), &|| ());
        Some(fitted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest};
    use crate::effects::find;
    use crate::identify::fixtures::{axis, multisine, stepped_sine};
    use crate::identify::request::IdentifyRequest;
    use crate::observer::Silent;
    use crate::plant::Actuator;

    fn request() -> IdentifyRequest {
        let mut options = IdentifyOptions::default();
        options.network.enabled = false;
        options.colony.enabled = false;
        let plant = Some(PlantRequest { actuator_order: 0 });
        IdentifyRequest { plant, options, ..IdentifyRequest::default() }
    }

    /// An axis with an actuator, which the models of these tests lack.
    const ACTUATOR: Actuator = Actuator::FirstOrder { corner_rad_s: 60.0 };

    /// The base model with a lag of the sensor that is not fitted.
    fn lagging(session: &FitSession<'_>) -> Model {
        session.extend(session.base(), find("sensor_lag").unwrap())
    }

    #[test]
    fn cosines_have_no_coarse_problem() {
        let (measurement, request) = (stepped_sine(&axis(ACTUATOR), 3), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        assert!(session.coarse.is_none());
    }

    #[test]
    fn the_base_model_has_the_same_residuals_on_both_problems_and_others_nearly_so() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let samples = |problem: &Problem| {
            let excitation = &problem.experiments[0].excitation;
            excitation.grid().map(|grid| grid.samples())
        };
        let coarse = session.coarse.as_ref().unwrap();
        assert!(2 * samples(&coarse.problem).unwrap() <= samples(&session.problem).unwrap());
        let apart = |model: &Model| {
            let fine = session.misfit(model).residuals(&model.point).unwrap();
            let coarse = session.search_misfit(model).residuals(&model.point).unwrap();
            (coarse - &fine).norm() / fine.norm()
        };
        // Rounding of the data, of size 1, beside residuals of some per cent.
        assert!(apart(session.base()) < 1e-12);
        let defect = |model: &Model| {
            let Coarse { problem, .. } = coarse;
            let misfit = session.misfit(model);
            let fine = misfit.predict(&model.point).unwrap();
            let coarse = Misfit { problem, ..misfit }.predict(&model.point).unwrap();
            let apart = fine[0].iter().zip(&coarse[0]).map(|(a, b)| (a - b).norm_sqr());
            apart.sum::<f64>().sqrt()
        };
        let lagging = lagging(&session);
        let residuals = session.misfit(&lagging).residuals(&lagging.point).unwrap().norm();
        // The correction takes most of the error of the coarse simulation away.
        assert!(apart(&lagging) * residuals < 0.3 * defect(&lagging));
    }

    #[test]
    fn a_settled_fit_ends_at_the_minimum_of_the_fine_problem() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let settled = session.refine(&lagging(&session), FitAccuracy::Settle);
        let fine = session.cost(&settled).unwrap();
        assert!((fine / settled.cost - 1.0).abs() < 1e-9, "{fine} {}", settled.cost);
        let best = session.refine(&settled, FitAccuracy::Thorough);
        let excess = settled.cost / best.cost - 1.0;
        // The tolerance of a settled fit.
        assert!((0.0..1e-4).contains(&excess), "{excess}");
    }

    #[test]
    fn a_short_fit_counts_by_its_fine_cost_and_is_fitted_again_where_the_coarse_one_was_far_less() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let short = session.refine(&lagging(&session), FitAccuracy::Glance);
        let counted = session.from_rest(short.clone());
        assert_eq!(Some(counted.cost), session.cost(&short));
        assert_eq!(counted.point, short.point);
        let mut moved = short.clone();
        moved.shift([(0, 0.1)].into_iter(), 1.0);
        moved.cost = short.cost;
        let again = session.from_rest(moved.clone());
        assert!(again.cost < session.cost(&moved).unwrap());
        assert!(again.cost <= (1.0 + LARGEST_DISAGREEMENT) * short.cost, "{again:?}");
    }
}
