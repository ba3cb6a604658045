//! Cross-validation: what models predict of data that neither their fit nor their choice has seen.
//!
//! Each part of the measurement is held out in turn. The base model and every model that may be
//! chosen are refitted to the rest, starting from their fit to all data. The causes are chosen
//! anew, and their predictions of the part are kept. A model is penalised as it is with all data.
//! The errors of models that are certainly not chosen are computed to first order, without a refit.

mod backward_elimination;
#[cfg(test)]
mod fixtures;
mod parsimony;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::answers::Gain;
use crate::identify::{FitSession, IdentifyError, LeavingOut, Model};

use super::cv_splits::{CvSplit, CvSplits};
use super::gain;
use super::heldout_predictions::{Predicted, Row, predicted};
use crate::diagnose::progress::{Part, Stage};
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::{Key, Models, ScoredModel};
use crate::observer::Observer as _;
pub(crate) use backward_elimination::Dropped;
use parsimony::differs_by_one;

/// Models whose −2 ln evidence exceeds the best by more than this are not refitted: no part of the
/// data makes up for it. Tuned.
const REFIT_MARGIN: f64 = 30.0;

/// Shortest time that a simulation is reckoned to take, for the progress, s.
const SHORTEST_S: f64 = 1e-6;

/// A model to be refitted without each part.
struct Refit<'m> {
    scored: &'m ScoredModel,
    /// `None` where it has no response.
    linear: Option<LeavingOut>,
    /// How long one simulation of it takes, for the progress.
    weight: f64,
}

/// Predictions of held-out data.
pub(crate) struct CrossValidation {
    /// Predictions of the base model.
    base: Predicted,
    /// Predictions of the models chosen without the part.
    chosen: Predicted,
    /// Predictions of each effect alone, of subsets of the effects chosen with all data, and of
    /// models with another effect in place of one of these.
    by_effects: BTreeMap<Key, Predicted>,
    /// NRMSE of each effect alone; to first order where it was not refitted.
    errors: BTreeMap<&'static str, f64>,
    /// The effects that were chosen without each part.
    choices: Vec<Key>,
    /// Group of every row that is held out.
    groups: BTreeMap<Row, usize>,
    noise_known: bool,
    what: String,
}

impl CrossValidation {
    /// Cross-validates `models`, fitted to all data of `session`, of which the one with the effects
    /// `chosen` was chosen.
    ///
    /// # Errors
    /// When cancelled, or if the base model cannot be fitted without some part.
    pub fn of(
        session: &FitSession<'_>,
        (models, chosen): (&Models, &Key),
        splits: &CvSplits,
        part: Part<'_>,
    ) -> Result<Self, IdentifyError> {
        const STAGE: &str = "predicting data held out";
        part.stage(STAGE, 1);
        let base = session.leaving_out(session.base()).ok_or(IdentifyError::Cancelled)?;
        let mut refits: Vec<Refit<'_>> = refitted(models)
            .into_par_iter()
            .map(|scored| {
                let began = part.elapsed_s();
                let linear = session.leaving_out(&scored.model);
                // Equal where nobody has a clock.
                Refit { scored, linear, weight: (part.elapsed_s() - began).max(SHORTEST_S) }
            })
            .collect();
        // Those that take longest come first, so that no thread waits for the last one.
        refits.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        // With each part the base model and these are refitted, and then the predictions made.
        let (count, steps) = (splits.parts.len(), refits.len() + 2);
        let work = 2.0 * SHORTEST_S + refits.iter().map(|refit| refit.weight).sum::<f64>();
        let stage = part.weighted_stage(STAGE, count * steps, count as f64 * work);
        let mut this = Self {
            base: Predicted::new(),
            chosen: Predicted::new(),
            by_effects: BTreeMap::new(),
            errors: BTreeMap::new(),
            choices: Vec::new(),
            groups: splits.parts.iter().flat_map(|fold| fold.rows.clone()).collect(),
            noise_known: session.noise_known(),
            what: splits.what.clone(),
        };
        for fold in &splits.parts {
            this.add(session, (&base, &refits), (models, chosen), fold, (part, &stage))?;
        }
        let singles: Vec<(&Key, &Model)> = models.all().filter(|(key, _)| key.len() == 1).collect();
        let error = |(key, model): (&Key, &Model)| {
            let error = match this.by_effects.get(key) {
                Some(predicted) => gain::error(predicted),
                None => session.leaving_out(model)?.error(|e, order| splits.part_of(e, order)),
            };
            Some((key[0], error?))
        };
        this.errors = singles.into_par_iter().filter_map(error).collect();
        Ok(this)
    }

    /// Adds the predictions of one part.
    fn add(
        &mut self,
        session: &FitSession<'_>,
        (base, refits): (&LeavingOut, &[Refit<'_>]),
        (models, chosen): (&Models, &Key),
        fold: &CvSplit,
        (part, stage): (Part<'_>, &Stage<'_>),
    ) -> Result<(), IdentifyError> {
        let held = |e, order| fold.holds(e, order);
        let rest = session.without(held, base)?;
        stage.begin_weighted(SHORTEST_S).finish();
        let lacking = session.data() - rest.data();
        let noise_scale = NoiseScale {
            rounding: rest.rounding(),
            dof: (models.noise_scale.dof - lacking as f64).max(1.0),
            ..models.noise_scale
        };
        let mut fitted = Models::new(rest.base().clone(), noise_scale);
        fitted.family = models.family.clone();
        let refit = |Refit { scored, linear, weight }: &Refit<'_>| {
            let step = stage.begin_weighted(*weight);
            let on_step = || step.advance();
            let refit =
                |linear| rest.from_rest_watched(rest.refit(linear, held, &on_step), &on_step);
            let refitted = linear.as_ref().map(refit).map(|model| scored.refitted(model));
            step.finish();
            refitted
        };
        let fits: Vec<Option<ScoredModel>> = refits.par_iter().map(refit).collect();
        fits.into_iter().flatten().for_each(|scored| fitted.keep(scored));
        let choice = fitted.best_supported();
        let predict_held_out = |model: &Model| -> Predicted {
            if part.cancelled() {
                return Predicted::new();
            }
            let mut all = predicted(&session.compare(model, |e| fold.holds_some(e)));
            all.retain(|row, _| fold.rows.contains_key(row));
            all
        };
        let is_part = |key: &Key| key.iter().all(|id| chosen.contains(id));
        let wanted = |key: &Key| {
            key.len() < 2 || *key == choice || is_part(key) || differs_by_one(key, chosen)
        };
        let all: Vec<(&Key, &Model)> = fitted.all().filter(|(key, _)| wanted(key)).collect();
        let all: Vec<(&Key, Predicted)> =
            all.into_par_iter().map(|(key, model)| (key, predict_held_out(model))).collect();
        for (key, predicted) in all {
            if *key == choice {
                self.chosen.extend(predicted.clone());
            }
            match key.is_empty() {
                true => self.base.extend(predicted),
                false => self.by_effects.entry(key.clone()).or_default().extend(predicted),
            }
        }
        self.choices.push(choice);
        stage.begin_weighted(SHORTEST_S).finish();
        Ok(())
    }

    /// The gain of all causes together, each part being predicted by the causes chosen without it.
    pub fn gain(&self, chosen: &Key) -> Option<Gain> {
        let others = self.choices.iter().filter(|choice| *choice != chosen);
        let described = |choice: &Key| match choice.as_slice() {
            [] => "nothing".to_owned(),
            causes => causes.join(" and "),
        };
        let others: Vec<String> = others.map(described).collect();
        let mut what = self.what.clone();
        if !others.is_empty() {
            what.push_str(&format!(
                "; when {} of these parts were held out, other causes were chosen: {}",
                others.len(),
                others.join(", ")
            ));
        }
        gain::gain(&self.base, &self.chosen, &self.groups, self.noise_known, what)
    }

    /// The gain of these effects, whatever was chosen without a part; `None` if not refitted.
    pub fn gain_of(&self, effects: &Key) -> Option<Gain> {
        self.between(&self.base, self.by_effects.get(effects)?)
    }

    /// The gain of an effect beside the other effects of a model; `None` if not refitted.
    pub fn gain_beside(&self, effects: &Key, id: &str) -> Option<Gain> {
        let others: Key = effects.iter().copied().filter(|other| *other != id).collect();
        let without =
            if others.is_empty() { Some(&self.base) } else { self.by_effects.get(&others) };
        self.between(without?, self.by_effects.get(effects)?)
    }

    fn between(&self, before: &Predicted, after: &Predicted) -> Option<Gain> {
        gain::gain(before, after, &self.groups, self.noise_known, self.what.clone())
    }

    /// NRMSE of the predictions of one effect alone.
    pub fn error_alone(&self, id: &str) -> Option<f64> {
        self.errors.get(id).copied()
    }
}

/// The models that are refitted without each part: those with effects that may be chosen.
fn refitted(models: &Models) -> Vec<&ScoredModel> {
    let near = models.within(REFIT_MARGIN);
    let is_near = |(key, _): &(&Key, &ScoredModel)| !key.is_empty() && near.contains(*key);
    models.scored().filter(is_near).map(|(_, scored)| scored).collect()
}
