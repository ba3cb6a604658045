//! Faults that records may have: another [`course`] of the input between its samples, a response that
//! is ahead of it ([`skew`]), another gain or delay of one experiment ([`one_run`]), or a channel that clips
//! ([`clipping`]).
//!
//! One is found where a model with it leaves only noise. Where more than noise remains whatever is
//! tried, as of a machine with small effects beside its large ones, another course is found if one effect
//! of the best model is not needed with it, and another fault, but no gain, if it is far better. That is
//! enough at any time where the noise was measured: an effect behind the fault may be none of those
//! that fit best without it. A gain is not: it follows whatever depends on the amplitude.

use crate::answers::{FaultKind, MeasurementFault};
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::selection::evidence;
use crate::diagnose::selection::models::Key;
use crate::identify::{FitAccuracy, FitSession, Intervals, Model};
use crate::measurement::Complex;

use super::beside::{self, OneNumber};
use super::candidates::FAULT_COST;
use super::clipping;
use super::course;
use super::one_run::OneRun;
use super::scan::FAR_SMALLER;
use super::skew::Skew;
use super::suspects::{CLEARLY_BETTER, Suspected, Suspects};

/// Models that are tried with each fault where the best leaves only noise: those of most evidence,
/// and all that are parts of the best.
const MOST_TRIED: usize = 4;

/// The best model of a record with one of these faults, if it is better than every model without;
/// `wanted` says which models are tried.
pub(crate) fn best(suspects: &Suspects<'_>, wanted: impl Fn(&Key) -> bool) -> Option<Suspected> {
    if !suspects.are_enough() {
        return None;
    }
    let mut search = Search::of(suspects, wanted)?;
    for kind in course::COURSES {
        let Some(session) = course::with(suspects, kind) else { continue };
        for start in search.starts.clone() {
            if !search.may_be_brought_down(&start) {
                continue;
            }
            let saves = start.effects().len() < search.effects;
            let price = course::ONE_OF_THREE + if saves { 0.0 } else { course::SAVES_NONE };
            let glanced = session.refine(&start, FitAccuracy::Glance);
            if search.is_beaten(&session, &glanced, price) {
                continue;
            }
            let model = session.refine(&glanced, FitAccuracy::Settle);
            search.consider(&session, &model, &[MeasurementFault::of(kind)], price);
        }
    }
    search.settle_starts();
    let experiments = suspects.session.measurement().experiments();
    for start in search.starts.clone() {
        search.fit_beside(&start, &[Skew { mended_s: suspects.lead_s }]);
    }
    if experiments.len() > 1 {
        for start in search.starts_of_runs() {
            search.fit_beside(&start, &OneRun::gains(experiments));
            search.fit_beside(&start, &OneRun::phases(experiments));
        }
    }
    let faults = clipping::faults(experiments);
    if let Some(session) = clipped(suspects, &faults) {
        let price = FAULT_COST * faults.len() as f64;
        let (base, best) = (suspects.session.base().clone(), search.best_model.clone());
        for start in search.starts.clone().into_iter().chain([base, best]) {
            let model = session.refine(&start, FitAccuracy::Settle);
            search.consider(&session, &model, &faults, price);
        }
    }
    search.best
}

/// The base model of a record with another gain or delay of one experiment, if it leaves only noise.
pub(super) fn another_run_beside_the_base_model(suspects: &Suspects<'_>) -> Option<Suspected> {
    if !suspects.are_enough() {
        return None;
    }
    let mut search = Search::of(suspects, |_| true)?;
    let base = suspects.session.base();
    let experiments = suspects.session.measurement().experiments();
    search.fit_beside(base, &OneRun::gains(experiments));
    search.fit_beside(base, &OneRun::phases(experiments));
    search.best
}

/// The data with the channels that seem to clip clipping; `None` if none does.
fn clipped<'a>(suspects: &Suspects<'a>, faults: &[MeasurementFault]) -> Option<FitSession<'a>> {
    if faults.is_empty() {
        return None;
    }
    let experiments = suspects.session.measurement().experiments();
    let clipping = |index: usize| experiments[index].clipping.as_deref();
    let filled = |index: usize, k: usize| {
        let before = experiments[index].input[k];
        let filled = clipping(index).and_then(|clipping| clipping.filled.as_ref());
        let after = filled.and_then(|filled| filled.input.get(k));
        let ratio = after.filter(|_| before != Complex::ZERO).map(|after| after / before);
        ratio.unwrap_or(Complex::ONE)
    };
    let unknown = |index: usize| {
        let filled = clipping(index).and_then(|clipping| clipping.filled.as_ref());
        filled.map_or(&[][..], |filled| &filled.unknown_input)
    };
    let ranged = suspects.session.with_range(|index| clipping(index)?.range)?;
    ranged.with_input(filled)?.with_unknown_input(unknown)
}

/// Models without a fault, and the best with one so far.
struct Search<'a> {
    suspects: &'a Suspects<'a>,
    /// Models that are tried with a fault.
    starts: Vec<Model>,
    /// The best model without a fault, and the number of its effects.
    best_model: Model,
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
        let (least, best, best_model) = (without, None, best_model.clone());
        Some(Self { suspects, starts, best_model, effects, more_is_left, without, least, best })
    }

    /// Models that are tried with another gain or phase of one experiment. Where more than noise is left,
    /// such a fault may have been followed by several effects; the base model and every effect alone come
    /// first then.
    fn starts_of_runs(&self) -> Vec<Model> {
        let Suspects { session, models, .. } = *self.suspects;
        if !self.more_is_left {
            return self.starts.clone();
        }
        let alone = models.all().filter(|(key, model)| key.len() == 1 && model.cost.is_finite());
        let alone = alone.map(|(_, model)| model.clone());
        std::iter::once(session.base().clone()).chain(alone).chain(self.starts.clone()).collect()
    }

    /// Fits the starts that are parts of another model. What a fault explains is counted from a fit.
    fn settle_starts(&mut self) {
        let session = self.suspects.session;
        for start in self.starts.iter_mut().filter(|start| !start.cost.is_finite()) {
            *start = match start.effects() {
                [] => session.base().clone(),
                _ => session.refine(start, FitAccuracy::Settle),
            };
        }
    }

    /// Whether a model beside a fault leaves far less, beyond noise, than the fault explains. An effect
    /// that is taken for another gain leaves more.
    fn leaves_little(&self, model: &Model) -> bool {
        let beyond_noise = model.cost - self.suspects.dof();
        beyond_noise < FAR_SMALLER * (self.best_model.cost - model.cost)
    }

    /// Whether the noise is known beside the model, whatever the weights are.
    fn noise_is_measured(&self) -> bool {
        let experiments = self.suspects.session.measurement().experiments();
        experiments.iter().all(|experiment| experiment.has_repeats() || experiment.std_given())
    }

    /// Whether a course of the input may bring a model down to the noise.
    fn may_be_brought_down(&self, model: &Model) -> bool {
        self.more_is_left
            || !self.suspects.size_known()
            || model.cost < course::MOST_LEFT * self.suspects.dof()
    }

    /// Fits a model beside that of these faults which explains most.
    fn fit_beside(&mut self, start: &Model, faults: &[impl OneNumber]) {
        if faults.is_empty() {
            return;
        }
        let suspects = self.suspects;
        let complexity =
            evidence::complexity(suspects.session, start, &suspects.models.noise_scale);
        if let Some(found) = beside::best(suspects, start, self.least - complexity, faults) {
            self.consider(&found.session, &found.model, &[found.fault], found.price);
        }
    }

    /// −2 ln evidence of a model with a fault of this price.
    fn criterion(&self, session: &FitSession<'_>, model: &Model, price: f64) -> f64 {
        let complexity = evidence::complexity(session, model, &self.suspects.models.noise_scale);
        self.suspects.misfit_of_noise(model.cost) + complexity + price
    }

    /// Whether a model with a fault is so far from the best after its first steps that the rest of its fit
    /// would be in vain: a fault that is there changes the response a little, and those steps follow it.
    fn is_beaten(&self, session: &FitSession<'_>, glanced: &Model, price: f64) -> bool {
        self.criterion(session, glanced, price) > self.least + CLEARLY_BETTER
    }

    /// Keeps a model with a fault if it is better than what was found before.
    fn consider(
        &mut self,
        session: &FitSession<'_>,
        fitted: &Model,
        faults: &[MeasurementFault],
        price: f64,
    ) {
        let suspects = self.suspects;
        let coarse = self.criterion(session, fitted, price);
        if coarse >= self.least {
            return;
        }
        let model = session.verified(fitted);
        let misfit = |model: &Model| suspects.misfit_of_noise(model.cost);
        let criterion = coarse - misfit(fitted) + misfit(&model);
        if criterion >= self.least {
            return;
        }
        let Ok(fit) = session.judge(&model, Intervals::Curvature) else { return };
        let observer = session.observer();
        let is_clear = self.without - criterion > CLEARLY_BETTER;
        let enough = match faults.first().map(|fault| fault.fault) {
            Some(FaultKind::RunGain | FaultKind::RunPhase) => {
                is_clear && self.leaves_little(&model)
            }
            Some(kind) if course::COURSES.contains(&kind) => self.more_is_left,
            _ => is_clear && (self.more_is_left || self.noise_is_measured()),
        };
        if enough || discrepancy::is_noise(&fit, suspects.seed, observer) {
            self.least = criterion;
            self.best = Some(Suspected {
                faults: faults.to_vec(),
                criterion: suspects.best_without() - (self.without - criterion),
                price,
                effects: fitted.effects().len(),
            });
        }
    }
}
