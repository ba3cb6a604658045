//! All fitted models with their information criterion, and the best among them.

use std::collections::{BTreeMap, BTreeSet};

use crate::effects::Effect;
use crate::identify::{FitSession, Model};

use super::evidence;
use super::evidence::NoiseScale;
use super::familywise_threshold::FamilywiseThreshold;

/// Ids of a model's effects, in order.
pub(crate) type Key = Vec<&'static str>;

/// Ids of a model's effects, in order.
pub(crate) fn key(model: &Model) -> Key {
    let mut key: Key = model.effects().iter().map(|effect| effect.id()).collect();
    key.sort_unstable();
    key
}

/// A model that was fitted.
pub(crate) struct ScoredModel {
    /// The model.
    pub model: Model,
    /// −2 ln of what speaks for its parameters: see [`evidence`].
    complexity: f64,
}

impl ScoredModel {
    /// A fitted model, weighed by the motions that it reaches from rest.
    pub fn new(session: &FitSession<'_>, model: Model, noise_scale: &NoiseScale) -> Self {
        let model = session.from_rest(model);
        let complexity = evidence::complexity(session, &model, noise_scale);
        Self { model, complexity }
    }
}

/// Every model that was fitted, the best of those with the same effects.
pub(crate) struct Models {
    /// How costs are compared.
    pub noise_scale: NoiseScale,
    /// What an effect must gain at the base model.
    pub family: Option<FamilywiseThreshold>,
    scored: BTreeMap<Key, ScoredModel>,
}

impl Models {
    /// With nothing but the base model.
    pub fn new(base: Model, noise_scale: NoiseScale) -> Self {
        let base = ScoredModel { model: base, complexity: 0.0 };
        Self { noise_scale, family: None, scored: BTreeMap::from([(Key::new(), base)]) }
    }

    /// The model with these effects.
    pub fn get(&self, key: &Key) -> Option<&Model> {
        self.scored.get(key).map(|scored| &scored.model)
    }

    /// Models whose criterion exceeds that of the best by less than `reach`, with all that
    /// they contain.
    pub fn within(&self, reach: f64) -> BTreeSet<&Key> {
        let criteria = self.scored.keys().map(|key| self.criterion(key));
        let best = criteria.fold(f64::INFINITY, f64::min);
        let near: Vec<&Key> =
            self.scored.keys().filter(|key| self.criterion(key) < best + reach).collect();
        let is_part = |key: &&Key| near.iter().any(|near| key.iter().all(|id| near.contains(id)));
        self.scored.keys().filter(is_part).collect()
    }

    /// The effect with this id, where a fitted model has it.
    pub fn effect(&self, id: &str) -> Option<&'static dyn Effect> {
        let mut effects = self.scored.values().flat_map(|scored| scored.model.effects());
        effects.find(|effect| effect.id() == id).copied()
    }

    /// Every model by its effects.
    pub fn all(&self) -> impl Iterator<Item = (&Key, &Model)> {
        self.scored.iter().map(|(key, scored)| (key, &scored.model))
    }

    /// Keeps a model, unless one with the same effects fits better.
    pub fn keep(&mut self, scored: ScoredModel) {
        let key = key(&scored.model);
        let best = self.scored.get(&key).map_or(f64::INFINITY, |known| known.model.cost);
        if scored.model.cost < best {
            self.scored.insert(key, scored);
        }
    }

    /// −2 ln of what speaks for a model, on a noise scale.
    pub fn criterion(&self, key: &Key) -> f64 {
        self.scored.get(key).map_or(f64::INFINITY, |scored| {
            self.noise_scale.misfit(scored.model.cost) + scored.complexity
        })
    }

    /// By how much the misfit grows where this effect is taken away, everything
    /// else refitted; 0 where that was not computed.
    pub fn loss(&self, key: &Key, id: &str) -> f64 {
        let without: Key = key.iter().copied().filter(|other| *other != id).collect();
        let misfit = |key: &Key| {
            self.scored.get(key).map(|scored| self.noise_scale.misfit(scored.model.cost))
        };
        match (misfit(&without), misfit(key)) {
            (Some(without), Some(with)) => without - with,
            _ => 0.0,
        }
    }

    /// Whether an effect of a model gains more than so many times what chance makes any gain.
    pub fn exceeds(&self, key: &Key, id: &str, times: f64) -> bool {
        let limit = self.family.as_ref().map_or(f64::INFINITY, |family| family.limit(id));
        self.loss(key, id) > times * self.noise_scale.bar(limit)
    }

    /// Whether each effect of a model is more than chance.
    pub fn supported(&self, key: &Key) -> bool {
        key.iter().all(|id| self.exceeds(key, id, 1.0))
    }

    /// Models with so many effects, the best first.
    pub fn ranked(&self, effects: usize) -> Vec<Key> {
        let mut keys: Vec<Key> =
            self.scored.keys().filter(|key| key.len() == effects).cloned().collect();
        keys.sort_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
        keys
    }

    /// The best of the models each of whose effects is more than chance.
    pub fn best_supported(&self) -> Key {
        self.scored
            .keys()
            .filter(|key| self.supported(key))
            .min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)))
            .cloned()
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnose::tests::fitted_to;

    #[test]
    fn of_models_with_the_same_effects_the_best_fit_is_kept() {
        let models = fitted_to(&[(&["spring"], 300.0), (&["spring"], 200.0), (&["spring"], 250.0)]);
        assert_eq!(models.get(&vec!["spring"]).unwrap().cost, 200.0);
        assert!(models.get(&vec!["cogging"]).is_none());
    }

    #[test]
    fn an_effect_is_worth_what_the_misfit_grows_by_without_it() {
        let models = fitted_to(&[
            (&["spring"], 300.0),
            (&["sensor_lag"], 500.0),
            (&["spring", "sensor_lag"], 120.0),
        ]);
        let pair = vec!["sensor_lag", "spring"];
        assert_eq!(models.loss(&pair, "spring"), 380.0);
        assert_eq!(models.loss(&pair, "sensor_lag"), 180.0);
        // Nothing is known of a triple, nor of what its effects are worth.
        assert_eq!(models.loss(&vec!["cogging", "sensor_lag", "spring"], "cogging"), 0.0);
    }

    #[test]
    fn more_parameters_must_gain_more() {
        let models = fitted_to(&[(&["spring"], 200.0), (&["hardening_spring"], 199.0)]);
        assert_eq!(models.ranked(1), [vec!["spring"], vec!["hardening_spring"]]);
        assert_eq!(models.ranked(2).len(), 0);
    }
}
