//! The collection of fitted models, ranked by an information criterion.
//!
//! The criterion is −2 ln of the marginal likelihood (`evidence`): misfit plus penalty. The
//! smallest wins.

use std::collections::{BTreeMap, BTreeSet};

use crate::effects::Effect;
use crate::identify::{FitSession, Model};

use super::evidence;
use super::evidence::NoiseScale;
use super::familywise_threshold::FamilywiseThreshold;

/// Models whose criterion exceeds the best by at most this are verified by the fine simulation
/// before one is chosen: more than any of them counts as an alternative.
const VERIFIED_MARGIN: f64 = 30.0;

/// Ids of a model's effects, sorted.
pub(crate) type Key = Vec<&'static str>;

/// The key of a model.
pub(crate) fn key(model: &Model) -> Key {
    let mut key: Key = model.effects().iter().map(|effect| effect.id()).collect();
    key.sort_unstable();
    key
}

/// A fitted model with its penalty.
pub(crate) struct ScoredModel {
    /// The model.
    pub model: Model,
    /// The penalty for its parameters: [`evidence::complexity`].
    complexity: f64,
}

impl ScoredModel {
    /// Scores a fitted model, whose cost should be that of motions from rest:
    /// [`FitSession::from_rest`].
    pub fn new(session: &FitSession<'_>, model: Model, noise_scale: &NoiseScale) -> Self {
        let complexity = evidence::complexity(session, &model, noise_scale);
        Self { model, complexity }
    }

    /// The same model refitted to a part of the data, with the penalty that it has with all of them.
    pub fn refitted(&self, model: Model) -> Self {
        Self { model, complexity: self.complexity }
    }
}

/// Every fitted model; of several with the same effects only the best fit is kept.
pub(crate) struct Models {
    /// Turns costs into misfits.
    pub noise_scale: NoiseScale,
    /// By how much each effect must lower χ² beside the base model.
    pub family: Option<FamilywiseThreshold>,
    /// Models that predict held-out data about as well as the chosen one, where that leaves more
    /// than noise.
    pub predict_alike: BTreeSet<Key>,
    scored: BTreeMap<Key, ScoredModel>,
    noise_left: Remainder,
}

/// The part of a cost that noise or rounding accounts for.
struct Remainder {
    /// Its expectation.
    expected: f64,
    /// Its standard deviation.
    least: f64,
}

impl Models {
    /// A collection that holds only the base model.
    pub fn new(base: Model, noise_scale: NoiseScale) -> Self {
        let base = ScoredModel { model: base, complexity: 0.0 };
        let noise_left = match noise_scale.known {
            true => Remainder { expected: noise_scale.dof, least: (2.0 * noise_scale.dof).sqrt() },
            false => Remainder { expected: 0.0, least: noise_scale.rounding },
        };
        let scored = BTreeMap::from([(Key::new(), base)]);
        Self { noise_scale, family: None, predict_alike: BTreeSet::new(), scored, noise_left }
    }

    /// The model with these effects.
    pub fn get(&self, key: &Key) -> Option<&Model> {
        self.scored.get(key).map(|scored| &scored.model)
    }

    /// Models whose criterion exceeds the best one by less than `reach`, and every fitted model
    /// whose effects are a subset of theirs.
    pub fn within(&self, reach: f64) -> BTreeSet<&Key> {
        let criteria = self.scored.keys().map(|key| self.criterion(key));
        let best = criteria.fold(f64::INFINITY, f64::min);
        let near: Vec<&Key> =
            self.scored.keys().filter(|key| self.criterion(key) < best + reach).collect();
        let is_part = |key: &&Key| near.iter().any(|near| key.iter().all(|id| near.contains(id)));
        self.scored.keys().filter(is_part).collect()
    }

    /// The effect with this id, if a fitted model has it.
    pub fn effect(&self, id: &str) -> Option<&'static dyn Effect> {
        let mut effects = self.scored.values().flat_map(|scored| scored.model.effects());
        effects.find(|effect| effect.id() == id).copied()
    }

    /// What a model leaves beyond the noise that the measurement states: its cost less the expected
    /// χ², but at least the standard deviation of that. If no noise is stated, all of its cost.
    /// Infinite if it was not fitted.
    pub fn remainder(&self, key: &Key) -> f64 {
        let Remainder { expected, least } = self.noise_left;
        self.get(key).map_or(f64::INFINITY, |model| (model.cost - expected).max(least))
    }

    /// What the parameters of a model cost: its criterion without the misfit.
    pub fn complexity(&self, key: &Key) -> f64 {
        self.scored.get(key).map_or(f64::INFINITY, |scored| scored.complexity)
    }

    /// The posterior probability that an effect of some kind is present: Σ exp(−½·criterion) over
    /// the models that have one, as a share of the sum over all.
    pub fn probability(&self, is_of_kind: impl Fn(&str) -> bool) -> f64 {
        let criteria: Vec<(&Key, f64)> =
            self.scored.keys().map(|key| (key, self.criterion(key))).collect();
        let best = criteria.iter().map(|(_, criterion)| *criterion).fold(f64::INFINITY, f64::min);
        let weight = |criterion: f64| (-0.5 * (criterion - best)).exp();
        let sum = |with: &dyn Fn(&Key) -> bool| -> f64 {
            criteria.iter().filter(|(key, _)| with(key)).map(|(_, c)| weight(*c)).sum()
        };
        sum(&|key| key.iter().any(|id| is_of_kind(id))) / sum(&|_| true)
    }

    /// Every model with its key.
    pub fn all(&self) -> impl Iterator<Item = (&Key, &Model)> {
        self.scored().map(|(key, scored)| (key, &scored.model))
    }

    /// The same with their penalties.
    pub fn scored(&self) -> impl Iterator<Item = (&Key, &ScoredModel)> {
        self.scored.iter()
    }

    /// Keeps a model, unless one with the same effects fits as well.
    pub fn keep(&mut self, scored: ScoredModel) {
        let key = key(&scored.model);
        let best = self.scored.get(&key).map_or(f64::INFINITY, |known| known.model.cost);
        if scored.model.cost < best {
            self.scored.insert(key, scored);
        }
    }

    /// −2 ln evidence of a model, up to a constant; infinite if it was not fitted.
    pub fn criterion(&self, key: &Key) -> f64 {
        self.scored.get(key).map_or(f64::INFINITY, |scored| {
            self.noise_scale.misfit(scored.model.cost) + scored.complexity
        })
    }

    /// The growth of the misfit when the effect `id` is removed and everything else is refitted;
    /// 0 if one of the two models was not fitted.
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

    /// Whether an effect of a model lowers the misfit by more than `times` its family-wise limit.
    pub fn exceeds(&self, key: &Key, id: &str, times: f64) -> bool {
        let limit = self.family.as_ref().map_or(f64::INFINITY, |family| family.limit(id));
        self.loss(key, id) > times * self.noise_scale.bar(limit)
    }

    /// Whether every effect of a model exceeds its family-wise limit.
    pub fn supported(&self, key: &Key) -> bool {
        key.iter().all(|id| self.exceeds(key, id, 1.0))
    }

    /// Models with this number of effects, the best first.
    pub fn ranked(&self, effects: usize) -> Vec<Key> {
        let mut keys: Vec<Key> =
            self.scored.keys().filter(|key| key.len() == effects).cloned().collect();
        keys.sort_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
        keys
    }

    /// The model of smallest criterion among those whose effects all exceed their limits. It and
    /// those that come near it are verified by the fine simulation before.
    pub fn best_verified(&mut self, session: &FitSession<'_>) -> Key {
        let mut verified = BTreeSet::from([Key::new()]);
        loop {
            let near = self.within(VERIFIED_MARGIN).into_iter();
            let next: Vec<Key> = near.filter(|key| !verified.contains(*key)).cloned().collect();
            if next.is_empty() {
                return self.best_supported();
            }
            for key in next {
                if let Some(scored) = self.scored.get_mut(&key) {
                    scored.model = session.verified(&scored.model);
                }
                verified.insert(key);
            }
        }
    }

    /// The model of smallest criterion among those whose effects all exceed their limits.
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
    fn only_the_best_fit_of_models_with_the_same_effects_is_kept() {
        let models = fitted_to(&[(&["spring"], 300.0), (&["spring"], 200.0), (&["spring"], 250.0)]);
        assert_eq!(models.get(&vec!["spring"]).unwrap().cost, 200.0);
        assert!(models.get(&vec!["cogging"]).is_none());
    }

    #[test]
    fn the_loss_of_an_effect_is_the_growth_of_the_misfit_without_it() {
        let models = fitted_to(&[
            (&["spring"], 300.0),
            (&["sensor_lag"], 500.0),
            (&["spring", "sensor_lag"], 120.0),
        ]);
        let pair = vec!["sensor_lag", "spring"];
        assert_eq!(models.loss(&pair, "spring"), 380.0);
        assert_eq!(models.loss(&pair, "sensor_lag"), 180.0);
        // The triple was not fitted.
        assert_eq!(models.loss(&vec!["cogging", "sensor_lag", "spring"], "cogging"), 0.0);
    }

    #[test]
    fn more_parameters_must_gain_more() {
        let models = fitted_to(&[(&["spring"], 200.0), (&["hardening_spring"], 199.0)]);
        assert_eq!(models.ranked(1), [vec!["spring"], vec!["hardening_spring"]]);
        assert_eq!(models.ranked(2).len(), 0);
    }
}
