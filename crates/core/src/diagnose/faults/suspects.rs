//! Faults of the measurement that, beside a model, explain it better than any model alone.

use crate::answers::MeasurementFault;
use crate::identify::{FitSession, Intervals, Model, ModelFit};

use crate::diagnose::residuals::layout::Layout;
use crate::diagnose::residuals::residual::Residuals;
use crate::diagnose::selection::models::{Key, Models};

use super::family::Family;
use super::one_level_out;
use super::scan::Scan;
use super::trimmed;

/// Fewest degrees of freedom that tell a fault from a model.
const FEWEST_DOF: f64 = 20.0;

/// Where faults of the measurement beside one effect at most are better by this, −2 ln evidence, no
/// combination of effects is tried: it could explain no more than noise, and a second effect of
/// this size that shows just as a fault does is unlikely. Tuned.
pub(crate) const CLEARLY_BETTER: f64 = 200.0;

/// Models for which faults are estimated together with the model: those that a linearisation finds
/// best.
const MOST_REFITTED: usize = 4;

/// Faults beside a model.
pub(crate) struct Suspected {
    /// The faults.
    pub faults: Vec<MeasurementFault>,
    /// −2 ln evidence of the model with them.
    pub criterion: f64,
    /// What they cost of it.
    pub price: f64,
    /// Number of effects of the model.
    pub effects: usize,
}

/// Where the search for faults beside a model begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Begin {
    /// At the model fitted to all data.
    Refit,
    /// At the model as it is, which a part of the data does not fit.
    AsItIs,
}

/// What is searched for faults.
pub(crate) struct Suspects<'a> {
    /// The session.
    pub session: &'a FitSession<'a>,
    /// The fit of its base model.
    pub base: &'a ModelFit,
    /// The models that were fitted.
    pub models: &'a Models,
    /// Whether effects were combined, if one was not enough.
    pub combined: bool,
    /// Seed of the draws of noise.
    pub seed: u64,
    /// By how much the response was ahead of the input before that was mended, s.
    pub lead_s: f64,
}

impl Suspects<'_> {
    /// Whether there are enough data to tell a fault from a model.
    pub fn are_enough(&self) -> bool {
        self.dof() >= FEWEST_DOF
    }

    /// The best model of a table with faults, if it is better than every model without any, and leaves only
    /// noise or has one fault that explains nearly all; `wanted` says which models are tried.
    pub fn best(&self, wanted: impl Fn(&Key) -> bool) -> Option<Suspected> {
        if !self.are_enough() {
            return None;
        }
        let family = self.family();
        let fitted = self.models.all().filter(|(key, _)| wanted(key));
        let fitted = fitted.map(|(key, model)| (key.clone(), model.clone())).collect();
        let found = self.beside(fitted, Begin::Refit, &family);
        if !self.combined || self.leaves_only_noise() {
            return found;
        }
        // So many rows may be wrong that they hide each other and the effects.
        let trimmed = trimmed::fitted(self.session, self.models, &wanted);
        let beside_trimmed = self.beside(trimmed, Begin::AsItIs, &family);
        let best = found.into_iter().chain(beside_trimmed);
        let best = best.min_by(|a, b| a.criterion.total_cmp(&b.criterion));
        best.or_else(|| self.beside_one_level_out(wanted, &family))
    }

    /// The same, from fits without one level.
    fn beside_one_level_out(
        &self,
        wanted: impl Fn(&Key) -> bool,
        family: &Family,
    ) -> Option<Suspected> {
        let models = one_level_out::fitted(self.session, self.models, &self.layout(), wanted);
        self.beside(models, Begin::AsItIs, family)
    }

    /// The faults beside the base model, where nothing else was fitted.
    pub fn beside_the_base_model(&self) -> Option<Suspected> {
        self.beside_one_level_out(|_| true, &self.family())
    }

    /// The limits that chance passes seldom.
    fn family(&self) -> Family {
        let scan = self.scan(self.base, self.session.base().cost);
        Family::of(self.base, &scan.candidates(), self.seed)
    }

    /// The best of these models with faults, if it is better than every model without any.
    fn beside(
        &self,
        models: Vec<(Key, Model)>,
        begin: Begin,
        family: &Family,
    ) -> Option<Suspected> {
        let mut linear: Vec<(f64, Key, Model)> = Vec::new();
        for (key, model) in models {
            let Ok(fit) = self.session.judge(&model, Intervals::Curvature) else { continue };
            let Some(cost) = self.session.cost(&model) else { continue };
            let scan = self.scan(&fit, cost);
            let candidates = scan.candidates();
            let found = scan.select(&candidates, family);
            if !found.faults.is_empty() || found.std_factor.is_some() {
                let price: f64 = found.faults.iter().map(|(_, price)| price).sum();
                let criterion = found.misfit + price + self.models.complexity(&key);
                linear.push((criterion, key, model));
            }
        }
        // The base model first: its fits are quick, and the linearisation of a large fault is poor.
        linear.sort_by(|a, b| b.1.is_empty().cmp(&a.1.is_empty()).then(a.0.total_cmp(&b.0)));
        let mut best: Option<Suspected> = None;
        let mut bar = self.best_without();
        for (criterion, key, model) in linear.into_iter().take(MOST_REFITTED) {
            // A refit gains little beside what the linearisation promises.
            if best.is_some() && criterion > bar {
                break;
            }
            let refitted = self.fitted_together(&key, model, begin, family);
            if let Some(better) = refitted.filter(|refitted| refitted.criterion < bar) {
                bar = better.criterion;
                best = Some(better);
            }
        }
        best
    }

    /// Whether the best model without faults leaves only noise.
    fn leaves_only_noise(&self) -> bool {
        let least = self.models.all().map(|(_, model)| model.cost).fold(f64::INFINITY, f64::min);
        self.models.noise_scale.explains(least)
    }

    /// How the residuals are laid out.
    fn layout(&self) -> Layout {
        Residuals::of(self.base).layout
    }

    /// −2 ln evidence of the best model without faults.
    pub fn best_without(&self) -> f64 {
        let criteria = self.models.all().map(|(key, model)| {
            misfit(model.cost, self.dof(), self.size_known()) + self.models.complexity(key)
        });
        criteria.fold(f64::INFINITY, f64::min)
    }

    pub(super) fn dof(&self) -> f64 {
        self.models.noise_scale.dof
    }

    pub(super) fn size_known(&self) -> bool {
        self.models.noise_scale.known
    }

    /// −2 ln likelihood of a cost where the noise is as large as stated or larger, whichever is
    /// likelier.
    pub(super) fn misfit_of_noise(&self, cost: f64) -> f64 {
        let dof = self.dof();
        misfit(cost, dof, self.size_known() && cost <= dof)
    }

    pub(super) fn scan<'f>(&self, fit: &'f ModelFit, cost: f64) -> Scan<'f> {
        Scan::new(fit, cost, self.dof(), self.size_known())
    }
}

/// −2 ln likelihood of a cost, up to a constant that models of known and of unknown noise share.
pub(crate) fn misfit(cost: f64, dof: f64, size_known: bool) -> f64 {
    match size_known {
        true => cost,
        false => dof * (1.0 + (cost.max(f64::MIN_POSITIVE) / dof).ln()),
    }
}
