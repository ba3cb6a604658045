//! Nonlinear fits of effects added to a model, from the starting points that the score tests rank
//! highest (multistart).
//!
//! All promising effects are fitted for a few steps from several starts. Only the best starts of the
//! effects that may still win are then followed until they converge.

use rayon::prelude::*;

use crate::effects::{are_confusable, are_nested};
use crate::identify::{FitAccuracy, FitSession, Model, SearchSettings};
use crate::observer::Observer as _;

use super::score_tests::{Probe, Probed};
use crate::diagnose::progress::{Part, Remaining, Stage, Step, effects_in_words};
use crate::diagnose::selection::evidence::NoiseScale;

/// Shares of the progress of [`Fitter::fit`] after which short fits of every effect and full fits of
/// the best end, and fits from further starting points begin: of effects alone, and of effects
/// beside others, of which few are tried.
const ENDS_ALONE: [f64; 2] = [0.3, 0.65];
const ENDS_BESIDE: [f64; 2] = [0.1, 0.55];

/// Share of the remaining progress that one round of restarts takes. The number of rounds is not
/// known beforehand.
const RESTART_SHARE: f64 = 0.5;

/// A displaced parameter has come back if less than this share of its displacement is left (tuned).
const BACK: f64 = 0.1;

/// Sorts models by cost and drops those without a response.
fn best_first(mut models: Vec<Model>) -> Vec<Model> {
    models.retain(|model| model.cost.is_finite());
    models.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    models
}

/// Whether a fit that started from parameters of the last effect displaced by so many prior standard
/// deviations has come back without a gain: then it would end where `fit` did.
fn has_come_back(model: &Model, fit: &Model, displacement: f64) -> bool {
    let own = fit.parameters_of(fit.effects().len() - 1);
    let is_back = |i| model.shift_from(fit, i).abs() < BACK * displacement * fit.prior_std(i);
    model.cost >= fit.cost && own.into_iter().all(is_back)
}

/// Fits effects added to a model.
pub(crate) struct Fitter<'a> {
    /// The measurement and its base model.
    pub session: &'a FitSession<'a>,
    /// Progress, and whether the search was cancelled.
    pub part: Part<'a>,
    /// The scale of costs: when a fit explains the data.
    pub noise_scale: NoiseScale,
    /// Number of starts of a promising effect.
    pub starts: usize,
    /// Number of them that are followed until they converge.
    pub followed: usize,
}

impl Fitter<'_> {
    /// Adds every effect to `from` and fits it from its probes. Promising effects are tried from
    /// several starts. The best of them, the leader, is followed until it converges. Effects that are
    /// easily confused with it, or nearly as good so far, are followed as well.
    pub fn fit(
        &self,
        from: &Model,
        probed: &[Probed],
        promising: impl Fn(&Probed) -> bool + Sync,
    ) -> Vec<Model> {
        let effects = effects_in_words(from.effects().len() + 1);
        let stage = |span, what: &str, steps| {
            self.part.part(span).stage(format!("{effects}: {what}"), steps)
        };
        let [short_end, full_end] =
            if from.effects().is_empty() { ENDS_ALONE } else { ENDS_BESIDE };
        let short = stage([0.0, short_end], "short fits", probed.len());
        let try_out = |probed| {
            let tried = self.tried(probed, promising(probed));
            short.step();
            (probed, tried)
        };
        let mut tried: Vec<(&Probed, Vec<Model>)> = probed.par_iter().map(try_out).collect();
        tried.retain(|(_, models)| !models.is_empty());
        tried.sort_by(|a, b| a.1[0].cost.total_cmp(&b.1[0].cost));
        let Some(first) = tried.iter().position(|(probed, _)| promising(probed)) else {
            return tried.into_iter().filter_map(|(_, models)| models.into_iter().next()).collect();
        };
        let full = stage([short_end, full_end], "full fits", tried.len());
        let (probed, models) = tried.remove(first);
        let step = full.begin();
        let leader = self.settled(models, self.followed, &step).unwrap_or_else(|| from.clone());
        step.finish();
        let SearchSettings { rival_share, restart_remainder, .. } = *self.session.search();
        let least = rival_share * (from.cost - leader.cost);
        let counts = |fit: &Model| from.cost - fit.cost > least;
        let follow = |(rival, models): (&Probed, Vec<Model>)| {
            let step = full.begin();
            let is_rival = are_confusable(probed.effect, rival.effect) || counts(&models[0]);
            let followed = match is_rival {
                true => self.settled(models, self.followed, &step),
                false => models.into_iter().next(),
            };
            step.finish();
            followed
        };
        let mut fits: Vec<Model> = tried.into_par_iter().filter_map(follow).collect();
        fits.push(leader);
        let nested: Vec<&Model> = fits.iter().filter(|fit| counts(fit)).collect();
        let mut further = Remaining(self.part.part([full_end, 1.0]));
        let starts = format!("{effects}: further starts");
        let stage = further.take(RESTART_SHARE).stage(&starts, fits.len());
        let again = |fit| {
            let step = stage.begin();
            let again = self.refit_from_nested(fit, &nested, &step);
            step.finish();
            again
        };
        let again: Vec<Model> = fits.par_iter().filter_map(again).collect();
        fits.extend(again);
        let best = fits.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).cloned();
        // A fit that leaves little may have the right effect in a wrong local minimum.
        let most = restart_remainder * self.noise_scale.beyond(from.cost);
        let is_near = |best: &Model| self.noise_scale.beyond(best.cost) < most;
        fits.extend(best.filter(is_near).and_then(|best| {
            self.leave_local_minimum(
                &best,
                &|model| self.noise_scale.explains(model.cost),
                &mut |restarts| further.take(RESTART_SHARE).stage(&starts, restarts),
            )
        }));
        fits
    }

    /// The best fit reached by repeated restarts from displaced parameters, until one is `sufficient`
    /// or a round gains little; `None` if none is better. `begin` begins a stage of so many steps for
    /// each round.
    pub fn leave_local_minimum<'p>(
        &self,
        fit: &Model,
        sufficient: &dyn Fn(&Model) -> bool,
        begin: &mut dyn FnMut(usize) -> Stage<'p>,
    ) -> Option<Model> {
        let beyond = |model: &Model| self.noise_scale.beyond(model.cost);
        if sufficient(fit) {
            return None;
        }
        let next = self.refit_displaced(fit, begin).filter(|next| next.cost < fit.cost)?;
        let least = self.session.search().restart_improvement;
        let is_lower = beyond(&next) < (1.0 - least) * beyond(fit);
        let further = is_lower.then(|| self.leave_local_minimum(&next, sufficient, begin));
        Some(further.flatten().unwrap_or(next))
    }

    /// Restarts a fit with one or two parameters of its last effect displaced. Impacts and limits
    /// give the misfit many local minima, and a fit ends in the nearest.
    fn refit_displaced<'p>(
        &self,
        fit: &Model,
        begin: &mut dyn FnMut(usize) -> Stage<'p>,
    ) -> Option<Model> {
        let own = fit.parameters_of(fit.effects().len().checked_sub(1)?);
        let SearchSettings { restart_displacement, followed_restarts, .. } = *self.session.search();
        let sides = own.flat_map(|i| [(i, -restart_displacement), (i, restart_displacement)]);
        let sides: Vec<(usize, f64)> =
            sides.map(|(i, side)| (i, side * fit.prior_std(i))).collect();
        let alone = sides.iter().map(|side| vec![*side]);
        let both = sides.iter().enumerate().flat_map(|(n, one)| {
            let others = sides[n + 1..].iter().filter(|other| other.0 != one.0);
            others.map(|other| vec![*one, *other])
        });
        let shifted = |steps: Vec<(usize, f64)>| {
            let mut displaced = fit.clone();
            displaced.shift(steps.into_iter(), f64::INFINITY);
            displaced
        };
        let displaced: Vec<Model> = alone.chain(both).map(shifted).collect();
        let stage = begin(displaced.len() + 1);
        let glance = |model| {
            let refined = self.refine(model, FitAccuracy::Glance);
            stage.step();
            refined
        };
        let mut tried: Vec<Model> = displaced.par_iter().map(glance).collect();
        tried.retain(|model| !has_come_back(model, fit, restart_displacement));
        let step = stage.begin();
        let settled = self.settled(best_first(tried), followed_restarts, &step);
        step.finish();
        settled
    }

    /// Restarts a fit from the parameters of the best nested model, if that fits better: a model
    /// that contains another can fit no worse, and the contained one may fit as well.
    fn refit_from_nested(&self, fit: &Model, nested: &[&Model], step: &Step<'_>) -> Option<Model> {
        let own = *fit.effects().last()?;
        let is_nested =
            |other: &&&Model| other.effects().last().is_some_and(|o| are_nested(own, *o));
        let better = nested.iter().filter(is_nested).filter(|other| other.cost < fit.cost);
        let best = better.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let last = best.effects().len() - 1;
        self.settled(self.session.exchange((best, last), own).into(), self.followed, step)
    }

    /// Fits of a few steps from the probes of an effect, the best first.
    fn tried(&self, probed: &Probed, promising: bool) -> Vec<Model> {
        let starts = if promising { self.starts } else { 1 };
        let starts: Vec<&Probe> = probed.probes.iter().take(starts).collect();
        let glance = |probe: &&Probe| self.refine(&probe.start, FitAccuracy::Glance);
        let tried = starts.par_iter().map(glance).collect();
        best_first(tried)
    }

    /// Follows the first of these models until they converge, and returns the best.
    fn settled(&self, mut tried: Vec<Model>, followed: usize, step: &Step<'_>) -> Option<Model> {
        tried.truncate(followed);
        let settle = |model| self.refine_watched(model, FitAccuracy::Settle, &|| step.advance());
        let settled = tried.par_iter().map(settle).collect();
        best_first(settled).into_iter().next()
    }

    /// Fits a model; after a cancellation it is returned unchanged.
    pub fn refine(&self, model: &Model, effort: FitAccuracy) -> Model {
        self.refine_watched(model, effort, &|| ())
    }

    fn refine_watched(&self, model: &Model, effort: FitAccuracy, on_step: &dyn Fn()) -> Model {
        match self.part.cancelled() {
            true => model.clone(),
            false => self.session.refine_watched(model, effort, on_step),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::effects::find;
    use crate::machines::draw::NoiseStatement;
    use crate::machines::simulator::Effect;
    use crate::observer::Silent;

    // A model that contains another must reach its cost; a settled cost is accurate to 1e-5.
    #[test]
    fn play_that_fits_worse_than_the_joint_without_it_starts_again_from_there() {
        // A resonance at 40 rad/s with a tenth of the critical damping.
        let inertia = 0.4 * 0.6 / plant().constant;
        let joint = Effect::new(
            "flexible_mode",
            [
                ("load_inertia_fraction", 0.4),
                ("stiffness", 40.0 * 40.0 * inertia),
                ("damping", 0.2 * 40.0 * inertia),
            ],
        );
        let (measurement, request) = (multisine_record(plant(), &[joint], None, 5), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let base = session.base();
        let part = Part::of(&Silent);
        let noise_scale = NoiseScale { known: true, rounding: 0.0, dof: 100.0 };
        let fitter = Fitter { session: &session, part, noise_scale, starts: 1, followed: 2 };
        let with = |id: &str| session.extend(base, find(id).unwrap());
        let mut joint = with("flexible_mode");
        let places = session.start_points(joint.effects()[0]);
        let own = joint.parameters_of(0).zip(&places[places.len() / 2]);
        own.for_each(|(i, value)| joint.set(i, *value));
        let joint = fitter.refine(&joint, FitAccuracy::Settle);
        let costing = |cost: f64, id: &str| {
            let mut model = with(id);
            model.cost = cost;
            model
        };
        let lost = costing(2.0 * joint.cost, "backlash");
        let stage = part.stage("one effect: further starts", 1);
        let step = &stage.begin();
        let found = fitter.refit_from_nested(&lost, &[&joint], step).unwrap();
        assert_eq!(found.effects()[0].id(), "backlash");
        assert!(found.cost < joint.cost * (1.0 + 1e-5), "{} {}", found.cost, joint.cost);
        assert!(fitter.refit_from_nested(&joint, &[&lost], step).is_none());
        assert!(fitter.refit_from_nested(&costing(f64::MAX, "spring"), &[&joint], step).is_none());
    }

    #[test]
    fn a_displaced_start_has_come_back_where_it_is_near_and_fits_no_better() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let mut fit = session.extend(session.base(), find("stribeck").unwrap());
        fit.cost = 100.0;
        let last = fit.parameters_of(0).end - 1;
        let displaced = |share: f64, cost: f64| {
            let mut model = fit.clone();
            model.shift(std::iter::once((last, share * 0.35 * fit.prior_std(last))), f64::INFINITY);
            model.cost = cost;
            has_come_back(&model, &fit, 0.35)
        };
        assert!(displaced(0.05, 100.1));
        assert!(!displaced(0.2, 100.1));
        assert!(!displaced(0.05, 99.9));
    }

    #[test]
    fn a_fit_is_tried_from_aside_until_it_is_sufficient() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let part = Part::of(&Silent);
        let noise_scale = NoiseScale { known: true, rounding: 0.0, dof: 1.0 };
        let fitter = Fitter { session, part, noise_scale, starts: 1, followed: 1 };
        let lag = session.extend(session.base(), find("sensor_lag").unwrap());
        let lag = fitter.refine(&lag, FitAccuracy::Glance);
        let begin = &mut |steps| part.stage("one effect: further starts", steps);
        assert!(fitter.leave_local_minimum(&lag, &|_| true, begin).is_none());
        let mut astray = lag.clone();
        astray.set(lag.parameters_of(0).start, 5.0 * lag.value(lag.parameters_of(0).start));
        astray.cost = 10.0 * lag.cost;
        let found = fitter.leave_local_minimum(&astray, &|_| false, begin).unwrap();
        assert!(found.cost < 1.01 * lag.cost, "{} {}", found.cost, lag.cost);
    }
}
