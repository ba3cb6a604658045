//! Faults that a whole record may have: another [`course`] of its input between the samples, or a
//! response that is ahead of it ([`skew`]).
//!
//! One is found in two cases: with it a model leaves only noise; or more than noise remains whatever
//! is tried, and one effect of the best model is not needed with it. A machine with small effects
//! beside its large ones is of the second kind. Where the size of the noise is known, a skew that is far
//! better is found, too: an effect behind it may be none of those that fit best without it.

use crate::answers::MeasurementFault;
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::selection::evidence;
use crate::diagnose::selection::models::Key;
use crate::diagnose::selection::order_selection::CLEARLY_BETTER;
use crate::identify::{FitAccuracy, FitSession, Intervals, Model};

use super::course;
use super::skew;
use super::suspects::{Suspected, Suspects};

/// Models that are tried with each fault where the best leaves only noise: those of most evidence,
/// and all that are parts of the best.
const MOST_TRIED: usize = 4;

/// The best model with one of these faults, if it is better than every model without.
pub(super) fn best(suspects: &Suspects<'_>, wanted: impl Fn(&Key) -> bool) -> Option<Suspected> {
    let mut search = Search::of(suspects, wanted)?;
    for kind in course::COURSES {
        let Some(session) = course::with(suspects, kind) else { continue };
        for start in search.starts.clone() {
            if !search.may_be_brought_down(&start) {
                continue;
            }
            let model = session.refine(&start, FitAccuracy::Settle);
            let saves = model.effects().len() < search.effects;
            let price = course::ONE_OF_THREE + if saves { 0.0 } else { course::SAVES_NONE };
            search.consider(&session, &model, &MeasurementFault::of(kind), price);
        }
    }
    for start in search.starts.clone() {
        let complexity =
            evidence::complexity(suspects.session, &start, &suspects.models.noise_scale);
        if let Some(found) = skew::beside(suspects, &start, search.least - complexity) {
            search.consider(&found.session, &found.model, &found.fault, found.price);
        }
    }
    search.best
}

/// Models without a fault, and the best with one so far.
struct Search<'a> {
    suspects: &'a Suspects<'a>,
    /// Models that are tried with a fault.
    starts: Vec<Model>,
    /// Number of effects of the best model without a fault.
    effects: usize,
    /// Whether more than noise remains whatever was tried.
    more_is_left: bool,
    /// −2 ln evidence of the best model without a fault; and with one, as far as it is found.
    without: f64,
    least: f64,
    best: Option<Suspected>,
}

impl<'a> Search<'a> {
    fn of(suspects: &'a Suspects<'a>, wanted: impl Fn(&Key) -> bool) -> Option<Self> {
        let Suspects { session, models, combined, .. } = *suspects;
        let criterion = |key: &Key, model: &Model| {
            suspects.misfit_of_noise(model.cost) + models.complexity(key)
        };
        // A fit that failed has no cost.
        let fitted = models.all().filter(|(_, model)| model.cost.is_finite());
        let mut ranked: Vec<(&Key, &Model)> = fitted.collect();
        ranked.sort_by(|a, b| criterion(a.0, a.1).total_cmp(&criterion(b.0, b.1)));
        let (best_key, best_model) = *ranked.first()?;
        let without = criterion(best_key, best_model);
        let effects = best_key.len();
        let more_is_left = combined && !models.noise_scale.explains(best_model.cost);
        let starts: Vec<Model> = if more_is_left {
            (0..effects).map(|effect| session.reduce(best_model, effect)).collect()
        } else {
            let is_part = |key: &Key| key.iter().all(|id| best_key.contains(id));
            let mut wanted = ranked.into_iter().filter(|(key, _)| wanted(key));
            let mut starts: Vec<_> = wanted.by_ref().take(MOST_TRIED).collect();
            starts.extend(wanted.filter(|(key, _)| is_part(key)));
            starts.into_iter().map(|(_, model)| model.clone()).collect()
        };
        let (least, best) = (without, None);
        Some(Self { suspects, starts, effects, more_is_left, without, least, best })
    }

    /// Whether a course of the input may bring a model down to the noise.
    fn may_be_brought_down(&self, model: &Model) -> bool {
        self.more_is_left
            || !self.suspects.size_known()
            || model.cost < course::MOST_LEFT * self.suspects.dof()
    }

    /// Keeps a model with a fault if it is better than what was found before.
    fn consider(
        &mut self,
        session: &FitSession<'_>,
        fitted: &Model,
        fault: &MeasurementFault,
        price: f64,
    ) {
        let suspects = self.suspects;
        let complexity = evidence::complexity(session, fitted, &suspects.models.noise_scale);
        let criterion = |model: &Model| suspects.misfit_of_noise(model.cost) + complexity + price;
        if criterion(fitted) >= self.least {
            return;
        }
        let model = session.verified(fitted);
        let criterion = criterion(&model);
        if criterion >= self.least {
            return;
        }
        let Ok(fit) = session.judge(&model, Intervals::Curvature) else { return };
        let observer = session.observer();
        let is_clear = || {
            let is_course = course::COURSES.contains(&fault.fault);
            !is_course && suspects.size_known() && self.without - criterion > CLEARLY_BETTER
        };
        let leaves_noise = || discrepancy::is_noise(&fit, suspects.seed, observer);
        if self.more_is_left || is_clear() || leaves_noise() {
            self.least = criterion;
            self.best = Some(Suspected {
                faults: vec![fault.clone()],
                criterion: suspects.best_without() - (self.without - criterion),
                price,
                effects: fitted.effects().len(),
            });
        }
    }
}
