//! Cross-validation: what models predict of data that neither their fit nor their choice has seen.
//!
//! Each part of the measurement is held out in turn. The base model and every model that may be chosen
//! are fitted to the rest, starting from their fit to all data; the causes are chosen there anew, and
//! what they predict of the part is kept. For models that are certainly not chosen, the prediction is
//! worked out to first order instead of fitting them again.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::answers::Gain;
use crate::identify::{FitAccuracy, FitSession, IdentifyError, IdentifyRequest, Model};

use super::cv_splits::{CvSplit, CvSplits};
use super::gain;
use super::heldout_predictions::{Predicted, Row, predicted};
use crate::diagnose::progress::{Part, Quiet};
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::{Key, Models, ScoredModel};

/// Difference in −2 ln of the evidence to the best model beyond which a model is not fitted
/// again: no part of the data makes up for it.
const REACH: f64 = 30.0;

/// What was predicted of data not seen.
pub(crate) struct CrossValidation {
    /// By the base model.
    base: Predicted,
    /// By the models that were chosen without it.
    chosen: Predicted,
    /// By each effect alone, and by the effects that were chosen with all data and some of
    /// them.
    by_effects: BTreeMap<Key, Predicted>,
    /// NRMSE of each effect alone, of those that were not fitted again to first order.
    errors: BTreeMap<&'static str, f64>,
    /// The choices, one a part.
    choices: Vec<Key>,
    /// Group of every row.
    groups: BTreeMap<Row, usize>,
    noise_known: bool,
    what: String,
}

/// An effect without which the others predict the data no worse.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dropped {
    /// It.
    pub id: &'static str,
    /// The others.
    pub beside: Key,
    /// What it adds to them.
    pub gain: Gain,
}

impl CrossValidation {
    /// Fits `models`, which were fitted to all of a session's data and of which that with the
    /// effects `chosen` was chosen, to each part of it.
    ///
    /// # Errors
    /// When cancelled, or where the base model cannot be fitted to a part.
    pub fn of(
        session: &FitSession<'_>,
        request: &IdentifyRequest,
        (models, chosen): (&Models, &Key),
        splits: &CvSplits,
        part: Part<'_>,
    ) -> Result<Self, IdentifyError> {
        let stage = part.stage("held out", splits.parts.len());
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
            this.add(session, request, (models, chosen), fold, part)?;
            stage.step();
        }
        let singles: Vec<(&Key, &Model)> = models.all().filter(|(key, _)| key.len() == 1).collect();
        let error = |(key, model): (&Key, &Model)| {
            let error = match this.by_effects.get(key) {
                Some(predicted) => gain::error(predicted),
                None => session.error_left_out(model, |e, order| splits.part_of(e, order)),
            };
            Some((key[0], error?))
        };
        this.errors = singles.into_par_iter().filter_map(error).collect();
        Ok(this)
    }

    fn add(
        &mut self,
        session: &FitSession<'_>,
        request: &IdentifyRequest,
        (models, chosen): (&Models, &Key),
        fold: &CvSplit,
        part: Part<'_>,
    ) -> Result<(), IdentifyError> {
        let quietly = Quiet(&part);
        let own = FitSession::continued(&fold.fitted, request, &quietly, session)?;
        let lacking = session.data() - own.data();
        let noise_scale = NoiseScale {
            rounding: own.rounding(),
            dof: (models.noise_scale.dof - lacking as f64).max(1.0),
            ..models.noise_scale
        };
        let mut fitted = Models::new(own.base().clone(), noise_scale);
        fitted.family = models.family.clone();
        let near = models.within(REACH);
        let refit = |(_, model): (&Key, &Model)| {
            let model = own.refine(&own.adopt(session, model), FitAccuracy::Settle);
            ScoredModel::new(&own, model, &noise_scale)
        };
        let all: Vec<(&Key, &Model)> =
            models.all().filter(|(key, _)| !key.is_empty() && near.contains(*key)).collect();
        let fits: Vec<ScoredModel> = all.into_par_iter().map(refit).collect();
        fits.into_iter().for_each(|scored| fitted.keep(scored));
        let choice = fitted.best_supported();
        let foreseen = |model: &Model| -> Predicted {
            let is_held = |index| fold.rows.range((index, 0)..(index + 1, 0)).next().is_some();
            let mut all = predicted(&session.compare(&session.adopt(&own, model), is_held));
            all.retain(|row, _| fold.rows.contains_key(row));
            all
        };
        let is_part = |key: &Key| key.iter().all(|id| chosen.contains(id));
        let wanted = |key: &Key| key.len() < 2 || *key == choice || is_part(key);
        let all: Vec<(&Key, &Model)> = fitted.all().filter(|(key, _)| wanted(key)).collect();
        let all: Vec<(&Key, Predicted)> =
            all.into_par_iter().map(|(key, model)| (key, foreseen(model))).collect();
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
        Ok(())
    }

    /// What all causes together gain.
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
                "; without {} of these parts the choice was another: {}",
                others.len(),
                others.join(", ")
            ));
        }
        gain::gain(&self.base, &self.chosen, &self.groups, self.noise_known, what)
    }

    /// What these effects gain, whatever was chosen without some of the data; `None` where
    /// they were not fitted again.
    pub fn gain_of(&self, effects: &Key) -> Option<Gain> {
        self.between(&self.base, self.by_effects.get(effects)?)
    }

    /// What an effect adds to the other effects of a model.
    pub fn gain_beside(&self, effects: &Key, id: &str) -> Option<Gain> {
        let others: Key = effects.iter().copied().filter(|other| *other != id).collect();
        let without =
            if others.is_empty() { Some(&self.base) } else { self.by_effects.get(&others) };
        self.between(without?, self.by_effects.get(effects)?)
    }

    /// Takes effects away, one by one, without which the others predict the data no worse, the
    /// most useless first. One that is left alone is not the best alone because it was the best
    /// beside another: it stands back behind what `models` has better.
    pub fn prune(&self, models: &Models, effects: &mut Key) -> Vec<Dropped> {
        let mut dropped: Vec<Dropped> = Vec::new();
        while effects.len() > 1 {
            let beside = |id: &&'static str| {
                let others = effects.iter().copied().filter(|other| other != id).collect();
                Some(Dropped { id, beside: others, gain: self.gain_beside(effects, id)? })
            };
            let useless = effects.iter().filter_map(beside);
            let useless = useless.filter(|dropped| dropped.gain.interval95[0] <= 1.0);
            let least = useless.min_by(|a, b| a.gain.ratio.total_cmp(&b.gain.ratio));
            let Some(least) = least else { break };
            effects.clone_from(&least.beside);
            dropped.push(least);
        }
        if effects.len() == 1 && !dropped.is_empty() {
            let stays = |key: &Key| dropped.iter().all(|dropped| !key.contains(&dropped.id));
            let was_fitted = |key: &Key| self.by_effects.contains_key(key);
            let mut singles = models.ranked(1).into_iter();
            let best = singles.find(|key| stays(key) && was_fitted(key) && models.supported(key));
            *effects = best.unwrap_or_else(|| effects.clone());
        }
        dropped
    }

    fn between(&self, before: &Predicted, after: &Predicted) -> Option<Gain> {
        gain::gain(before, after, &self.groups, self.noise_known, self.what.clone())
    }

    /// NRMSE of the predictions of one effect alone.
    pub fn error_alone(&self, id: &str) -> Option<f64> {
        self.errors.get(id).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::ComparedHarmonic;
    use crate::diagnose::selection::familywise_threshold::FamilywiseThreshold;
    use crate::diagnose::tests::fitted_to;

    /// Twelve groups of one row, off by about this.
    fn off(by: f64) -> Predicted {
        let harmonic = |group: usize| ComparedHarmonic {
            order: 1,
            input: [1.0, 0.0],
            measured: [1.0, 0.0],
            simulated: [1.0 - by * (1.0 + 0.05 * (group as f64).sin()), 0.0],
            std: 0.1,
        };
        (0..12).map(|group| ((group, 1), harmonic(group))).collect()
    }

    fn cross_validation(by_effects: &[(&[&'static str], f64)]) -> CrossValidation {
        CrossValidation {
            base: off(0.5),
            chosen: Predicted::new(),
            by_effects: by_effects.iter().map(|(key, by)| (key.to_vec(), off(*by))).collect(),
            errors: BTreeMap::new(),
            choices: Vec::new(),
            groups: (0..12).map(|group| ((group, 1), group)).collect(),
            noise_known: false,
            what: String::new(),
        }
    }

    #[test]
    fn what_adds_nothing_to_the_others_goes_and_what_does_stays() {
        let cross_validation = cross_validation(&[
            (&["cogging"], 0.3),
            (&["spring"], 0.2),
            (&["stribeck"], 0.4),
            (&["cogging", "spring"], 0.1),
            (&["cogging", "stribeck"], 0.29),
            (&["spring", "stribeck"], 0.21),
            (&["cogging", "spring", "stribeck"], 0.11),
        ]);
        let mut effects = vec!["cogging", "spring", "stribeck"];
        let dropped = cross_validation.prune(&fitted_to(&[]), &mut effects);
        assert_eq!(effects, ["cogging", "spring"]);
        assert_eq!(dropped.len(), 1);
        assert_eq!((dropped[0].id, &dropped[0].beside), ("stribeck", &effects));
        // 0.1 over 0.11.
        assert!((dropped[0].gain.ratio - 1.0 / 1.1).abs() < 1e-12, "{dropped:?}");
    }

    // With a spring the play gains more than the elastic joint does; alone it gains less.
    #[test]
    fn what_is_left_alone_stands_back_behind_what_is_better_alone() {
        let cross_validation = cross_validation(&[
            (&["backlash"], 0.2),
            (&["flexible_mode"], 0.2),
            (&["spring"], 0.4),
            (&["backlash", "spring"], 0.2),
        ]);
        let mut models = fitted_to(&[
            (&["backlash"], 200.0),
            (&["flexible_mode"], 190.0),
            (&["backlash", "spring"], 150.0),
        ]);
        models.family =
            Some(FamilywiseThreshold::that_asks_for_little(&["backlash", "flexible_mode"]));
        let mut effects = vec!["backlash", "spring"];
        let dropped = cross_validation.prune(&models, &mut effects);
        assert_eq!((dropped[0].id, effects), ("spring", vec!["flexible_mode"]));
        assert_eq!(dropped[0].beside, ["backlash"]);
    }

    #[test]
    fn the_last_effect_and_what_was_not_fitted_without_stay() {
        let models = fitted_to(&[]);
        let mut effects = vec!["spring"];
        assert!(cross_validation(&[(&["spring"], 0.9)]).prune(&models, &mut effects).is_empty());
        let mut effects = vec!["cogging", "spring"];
        let unfitted = cross_validation(&[(&["cogging", "spring"], 0.9)]);
        assert!(unfitted.prune(&models, &mut effects).is_empty());
        assert_eq!(effects.len(), 2);
    }
}
