//! What models predict of data that neither their fit nor their choice has seen.
//!
//! Each part of a measurement is held out in turn. The base model and every model that may be
//! chosen are fitted to the rest, from where all data led them, the causes are chosen there
//! anew, and what they predict of the part is kept. Of models that are out of the question it
//! is worked out to first order what they would predict.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::answers::Gain;
use crate::identify::{Effort, IdentifyError, IdentifyRequest, Model, Workbench};

use super::evidence::Yardstick;
use super::folds::{Fold, Folds};
use super::gain;
use super::models::{Key, Models, Visited};
use super::predicted::{Predicted, Row, predicted};
use super::progress::{Part, Quiet};

/// Difference in −2 ln of the evidence to the best model beyond which a model is not fitted
/// again: no part of the data makes up for it.
const REACH: f64 = 30.0;

/// What was predicted of data not seen.
pub(super) struct Unseen {
    /// By the base model.
    base: Predicted,
    /// By the models that were chosen without it.
    chosen: Predicted,
    /// By each effect alone.
    alone: BTreeMap<&'static str, Predicted>,
    /// NRMSE of each effect alone, of those that were not fitted again to first order.
    errors: BTreeMap<&'static str, f64>,
    /// The choices, one a part.
    choices: Vec<Key>,
    /// Group of every row.
    groups: BTreeMap<Row, usize>,
    noise_known: bool,
    what: String,
}

impl Unseen {
    /// Fits `models`, which were fitted to all of a workbench's data, to each part of it.
    ///
    /// # Errors
    /// When cancelled, or where the base model cannot be fitted to a part.
    pub fn of(
        workbench: &Workbench<'_>,
        request: &IdentifyRequest,
        models: &Models,
        folds: &Folds,
        part: Part<'_>,
    ) -> Result<Self, IdentifyError> {
        let stage = part.stage("held out", folds.parts.len());
        let mut this = Self {
            base: Predicted::new(),
            chosen: Predicted::new(),
            alone: BTreeMap::new(),
            errors: BTreeMap::new(),
            choices: Vec::new(),
            groups: folds.parts.iter().flat_map(|fold| fold.rows.clone()).collect(),
            noise_known: workbench.noise_known(),
            what: folds.what.clone(),
        };
        for fold in &folds.parts {
            this.add(workbench, request, models, fold, part)?;
            stage.step();
        }
        let part_of = |experiment: usize, order: usize| {
            folds.parts.iter().position(|fold| fold.rows.contains_key(&(experiment, order)))
        };
        let singles: Vec<(&Key, &Model)> = models.all().filter(|(key, _)| key.len() == 1).collect();
        let error = |(key, model): (&Key, &Model)| {
            let error = match this.alone.get(key[0]) {
                Some(predicted) => gain::error(predicted),
                None => workbench.error_left_out(model, part_of),
            };
            Some((key[0], error?))
        };
        this.errors = singles.into_par_iter().filter_map(error).collect();
        Ok(this)
    }

    fn add(
        &mut self,
        workbench: &Workbench<'_>,
        request: &IdentifyRequest,
        models: &Models,
        fold: &Fold,
        part: Part<'_>,
    ) -> Result<(), IdentifyError> {
        let quietly = Quiet(&part);
        let own = Workbench::continued(&fold.fitted, request, &quietly, workbench)?;
        let lacking = workbench.data() - own.data();
        let yardstick = Yardstick {
            rounding: own.rounding(),
            dof: (models.yardstick.dof - lacking as f64).max(1.0),
            ..models.yardstick
        };
        let mut fitted = Models::new(own.base().clone(), yardstick);
        fitted.family = models.family.clone();
        let near = models.within(REACH);
        let refit = |(_, model): (&Key, &Model)| {
            let model = own.refine(&own.adopt(workbench, model), Effort::Settle);
            Visited::new(&own, model, &yardstick)
        };
        let all: Vec<(&Key, &Model)> =
            models.all().filter(|(key, _)| !key.is_empty() && near.contains(*key)).collect();
        let fits: Vec<Visited> = all.into_par_iter().map(refit).collect();
        fits.into_iter().for_each(|visited| fitted.keep(visited));
        let choice = fitted.best_supported();
        let foreseen = |model: &Model| -> Predicted {
            let is_held = |index| fold.rows.range((index, 0)..(index + 1, 0)).next().is_some();
            let mut all = predicted(&workbench.compare(&workbench.adopt(&own, model), is_held));
            all.retain(|row, _| fold.rows.contains_key(row));
            all
        };
        let all: Vec<(&Key, &Model)> =
            fitted.all().filter(|(key, _)| key.len() < 2 || **key == choice).collect();
        let all: Vec<(&Key, Predicted)> =
            all.into_par_iter().map(|(key, model)| (key, foreseen(model))).collect();
        for (key, predicted) in all {
            if *key == choice {
                self.chosen.extend(predicted.clone());
            }
            match key.as_slice() {
                [] => self.base.extend(predicted),
                [id] => self.alone.entry(id).or_default().extend(predicted),
                _ => {}
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

    /// What one effect alone gains.
    pub fn gain_alone(&self, id: &str) -> Option<Gain> {
        let alone = self.alone.get(id)?;
        gain::gain(&self.base, alone, &self.groups, self.noise_known, self.what.clone())
    }

    /// NRMSE of the predictions of one effect alone.
    pub fn error_alone(&self, id: &str) -> Option<f64> {
        self.errors.get(id).copied()
    }
}
