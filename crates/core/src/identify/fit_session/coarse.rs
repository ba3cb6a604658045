//! A coarse problem on which a search looks for the best model.
//!
//! Records are simulated on a fine grid. On a coarser one a simulation costs a fraction, and errs.
//! Nearly all of that error is common to all models worth looking at. So the data of the coarse
//! problem are shifted by the error of the base model, the defect: the base model then has the same
//! residuals on both. This is the defect correction of space mapping with a shift of the output
//! (Koziel, Cheng and Bandler 2008, doi:10.1109/MMM.2008.929554).
//!
//! How coarse the grid may be depends on the residuals: the coarsest one is taken whose defect is
//! negligible beside those of the base model and beside the noise, if that is known. A model that
//! leaves much less than the base model is fitted again on the fine problem before it is chosen.

use super::{FitAccuracy, FitSession, Model};
use crate::identify::objective::Misfit;
use crate::identify::problem::Problem;
use crate::measurement::Complex;
use crate::simulate::Counts;

/// Interpolation errors of the inputs that are tried, the coarsest grid first, as shares of their
/// rms: the first, the last, and the ratio of one to the next.
const INTERPOLATION_ERRORS: [f64; 3] = [0.1, 1e-5, 0.6];

/// Largest defect as a share of the residuals of the base model, both weighted by the noise (root of
/// the sum of squares). Uncorrected, it would change their sum of squares by at most 2 %.
const LARGEST_DEFECT: f64 = 0.01;

/// The same as a share of the noise, if that is known: χ² of a true model would, uncorrected, rise
/// by a hundredth.
const LARGEST_DEFECT_IN_NOISE: f64 = 0.1;

/// A fit on the coarse problem is repeated on the fine one if its cost differs there by more than
/// this share (tuned).
const LARGEST_DISAGREEMENT: f64 = 0.01;

/// A problem with coarse simulations, and data to match.
pub(super) struct Coarse {
    pub(super) problem: Problem,
    /// The responses of the base model on it.
    pub(super) stand_in: Vec<Vec<Complex>>,
}

impl FitSession<'_> {
    /// The coarse problem; `None` where it would save nothing, or no grid is accurate enough.
    pub(super) fn coarsened(&self) -> Option<Coarse> {
        let noise = if self.noise_known() { self.data() as f64 } else { f64::INFINITY };
        let most = (LARGEST_DEFECT * self.cost(&self.base)?.sqrt())
            .min(LARGEST_DEFECT_IN_NOISE * noise.sqrt());
        let coarse = |error: f64| {
            let problem = self.problem.coarser(error)?;
            let misfit = Misfit { problem: &problem, stand_in: None, ..self.misfit(&self.base) };
            let stand_in = misfit.predict(&self.base.point).ok()?;
            (self.defect(&stand_in) <= most).then_some(Coarse { problem, stand_in })
        };
        let [first, last, ratio] = INTERPOLATION_ERRORS;
        let errors = std::iter::successors(Some(first), |error| Some(error * ratio));
        let Coarse { mut problem, stand_in } =
            errors.take_while(|error| *error > last).find_map(coarse)?;
        for (experiment, (coarse, fine)) in
            problem.experiments.iter_mut().zip(stand_in.iter().zip(&self.stand_in))
        {
            for (target, (coarse, fine)) in
                experiment.targets.iter_mut().zip(coarse.iter().zip(fine))
            {
                // In another order these sums round differently, and EMPS ends in another minimum.
                target.value = target.value + coarse - fine;
            }
        }
        Some(Coarse { problem, stand_in })
    }

    /// What a coarse response lacks, for each target of each experiment: the difference between the
    /// fine and the coarse response of the base model.
    pub(super) fn corrections(&self, coarse: &Coarse) -> Vec<Vec<Complex>> {
        let experiments = self.stand_in.iter().zip(&coarse.stand_in);
        experiments
            .map(|(fine, coarse)| fine.iter().zip(coarse).map(|(f, c)| f - c).collect())
            .collect()
    }

    /// √Σ|ΔŶ|²/σ² between a coarse and the fine simulation of the base model.
    fn defect(&self, coarse: &[Vec<Complex>]) -> f64 {
        let weighted = coarse.iter().zip(&self.stand_in).zip(&self.fitted.weights.sigma);
        let squares = weighted.flat_map(|((coarse, fine), sigma)| {
            let each = coarse.iter().zip(fine).zip(sigma);
            each.map(|((coarse, fine), sigma)| ((coarse - fine) / sigma).norm_sqr())
        });
        squares.sum::<f64>().sqrt()
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

    /// Fits a model: on the coarse problem, if there is one, unless the fit is thorough.
    pub(super) fn descend(&self, model: &Model, effort: FitAccuracy, on_step: &dyn Fn()) -> Model {
        let misfit = match effort {
            FitAccuracy::Thorough => self.misfit(model),
            _ => self.search_misfit(model),
        };
        self.descend_by(&misfit, model, self.patience(effort), on_step)
    }

    /// A model that was fitted on the coarse problem, with its cost on the fine one. Where that
    /// differs by more than a hundredth, the model is fitted again on the fine one. Unchanged if
    /// there is no coarse problem.
    pub fn verified(&self, model: &Model) -> Model {
        if self.coarse.is_none() || !model.cost.is_finite() {
            return model.clone();
        }
        let misfit = Misfit { stand_in: None, counts: Counts::FromRest, ..self.misfit(model) };
        let cost = misfit.cost(&model.point);
        if (cost - model.cost).abs() <= LARGEST_DISAGREEMENT * model.cost {
            return Model { cost, ..model.clone() };
        }
        self.descend_by(&misfit, model, self.patience(FitAccuracy::Settle), &|| ())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

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
    fn a_coarse_comparison_is_corrected_by_the_error_of_the_base_model() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let mut session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let models = [session.base().clone(), lagging(&session)];
        let simulated = |session: &FitSession<'_>| {
            models.each_ref().map(|model| {
                let comparison = session.compare(model, |_| true);
                let all = comparison.experiments.iter().flat_map(|e| &e.harmonics);
                DVector::from_vec(all.flat_map(|h| h.simulated).collect::<Vec<_>>())
            })
        };
        let coarse = simulated(&session);
        session.coarse = None;
        let fine = simulated(&session);
        let [base, lagging] = [0, 1].map(|i| (&coarse[i] - &fine[i]).norm() / fine[i].norm());
        assert!(base < 1e-12 && lagging < 1e-4, "{base} {lagging}");
        let residual = (&fine[0] - &fine[1]).norm() / fine[0].norm();
        assert!(residual > 100.0 * lagging, "the two models differ by {residual}");
    }

    #[test]
    fn the_grid_is_as_coarse_as_what_the_base_model_leaves_and_the_noise_allow() {
        let coarse_samples = |noise_std: Option<f64>| {
            let options = IdentifyOptions { noise_std, ..request().options };
            let (measurement, request) =
                (multisine(&axis(ACTUATOR)), IdentifyRequest { options, ..request() });
            let session = FitSession::new(&measurement, &request, &Silent).unwrap();
            let coarse = session.coarse?;
            coarse.problem.experiments[0].excitation.grid().map(|grid| grid.samples())
        };
        // The residuals are some per cent of a velocity of the order of 1.
        let [by_residuals, by_noise] = [None, Some(1e-6)].map(coarse_samples);
        assert!(
            by_residuals.unwrap() < by_noise.unwrap_or(usize::MAX),
            "{by_residuals:?} {by_noise:?}"
        );
    }

    // The data are exact, and the model leaves a hundredth of what the base model does.
    #[test]
    fn a_coarse_fit_ends_at_the_fine_minimum_even_where_it_leaves_far_less_than_the_base_model() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let settled = session.refine(&lagging(&session), FitAccuracy::Settle);
        assert!(settled.cost < 0.01 * session.base().cost);
        let verified = session.verified(&settled);
        let best = session.refine(&verified, FitAccuracy::Thorough);
        let excess = verified.cost / best.cost - 1.0;
        // The tolerance of a settled fit.
        assert!((0.0..1e-4).contains(&excess), "{excess}");
    }

    #[test]
    fn a_fit_whose_cost_is_the_same_on_both_problems_is_kept_and_another_is_repeated() {
        let (measurement, request) = (multisine(&axis(ACTUATOR)), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let short = session.refine(&lagging(&session), FitAccuracy::Glance);
        let counted = session.verified(&short);
        assert_eq!(Some(counted.cost), session.cost(&short));
        assert_eq!(counted.point, short.point);
        let mut moved = short.clone();
        moved.shift([(0, 0.1)].into_iter(), 1.0);
        moved.cost = short.cost;
        let again = session.verified(&moved);
        assert!(again.cost < session.cost(&moved).unwrap());
        assert!(again.cost <= (1.0 + LARGEST_DISAGREEMENT) * short.cost, "{again:?}");
    }
}
