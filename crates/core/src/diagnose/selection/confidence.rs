//! The confidence in a cause: how often causes that stand out as far as this one are right.
//!
//! Where one effect leaves only noise, the confidence is its posterior probability among the fitted
//! models (Bayesian model averaging). Where more is left, that is not noise but effects that no
//! model has; where several effects are needed, they may imitate another. Posterior probabilities
//! are then far too sure, and the confidence follows from how far the effect stands out: by the
//! ratio of the χ² beyond the noise that the best model without it and the chosen one leave. Two
//! effects that are each other's closest imitators stand out together, and share the confidence by
//! what either leaves.
//!
//! The logistic function was fitted to draws of the benchmark; docs/decisions.md says how.

use super::causes::{convincing, rivals};
use super::evidence::CHANCE_GAIN;
use super::models::{Key, Models};
use crate::effects::{are_closest_imitators, is_special_case};

/// ln(p/(1 − p)) of an effect without which the best model leaves as much.
const INTERCEPT: f64 = -6.5;

/// By how much that rises with the logarithm of the factor.
const SLOPE: f64 = 3.1;

/// How often effects are right that do not stand out at all: small ones that the machine has.
const LEAST: f64 = 0.19;

/// Of two imitators, the odds are the ratio of what they leave, to this power.
const IMITATOR_POWER: f64 = 6.0;

/// How far the effects of a model stand out among the fitted models.
pub(crate) struct Standing<'a> {
    /// The fitted models.
    pub models: &'a Models,
    /// The effects of the chosen one.
    pub chosen: &'a Key,
}

impl Standing<'_> {
    /// The confidence in an effect of the model; `fits` says whether the model leaves only noise.
    pub fn confidence(&self, id: &'static str, fits: bool) -> f64 {
        if fits && convincing(self.models, self.chosen) {
            return self.models.probability(|other| other == id);
        }
        let logit = INTERCEPT + SLOPE * self.factor(id).ln();
        let right = LEAST + (1.0 - LEAST) / (1.0 + (-logit).exp());
        right * self.share_among_imitators(id)
    }

    /// The effects that fit as well in the place of one, and its closest imitator. Effects of the
    /// model do not count.
    fn imitators(&self, id: &'static str) -> Vec<&'static str> {
        let Self { models, chosen } = self;
        let mut found: Vec<&'static str> =
            rivals(models, chosen, id).into_iter().map(|rival| rival.0).collect();
        let own = models.effect(id);
        let is_closest = |other: &'static str| {
            let effects = own.zip(models.effect(other));
            effects.is_some_and(|(one, other)| are_closest_imitators(one, other))
        };
        for other in models.all().flat_map(|(key, _)| key) {
            if is_closest(other) && !chosen.contains(other) && !found.contains(other) {
                found.push(other);
            }
        }
        found
    }

    /// The factor by which the best model without an effect and its imitators leaves more than the
    /// chosen one. It has no more effects than that.
    pub fn factor(&self, id: &'static str) -> f64 {
        let imitators = self.imitators(id);
        let is_alike = |other: &&str| *other == id || imitators.contains(other);
        let lacks = |key: &Key| key.len() <= self.chosen.len() && !key.iter().any(&is_alike);
        (self.least(lacks) / self.models.remainder(self.chosen)).max(f64::MIN_POSITIVE)
    }

    fn least(&self, is_meant: impl Fn(&Key) -> bool) -> f64 {
        let meant = self.models.all().map(|(key, _)| key).filter(|key| is_meant(key));
        meant.map(|key| self.models.remainder(key)).fold(f64::INFINITY, f64::min)
    }

    /// The share of the confidence that an effect has among its imitators: by what the best models
    /// with one of them in its place leave, and by what their parameters cost. Data held out may have
    /// preferred the effect to an imitator that leaves less; then their odds are even. An imitator that
    /// has the effect as a special case and lowers the misfit no further is that effect.
    fn share_among_imitators(&self, id: &'static str) -> f64 {
        let Self { models, chosen } = self;
        let cost =
            |key: &Key| IMITATOR_POWER * models.remainder(key).ln() + 0.5 * models.complexity(key);
        let own = cost(chosen);
        let odds = |imitator: &'static str| {
            let replaces = |key: &&Key| {
                key.len() == chosen.len() && key.contains(&imitator) && !key.contains(&id)
            };
            let keys = models.all().map(|(key, _)| key).filter(replaces);
            let costs = keys.filter(|key| !self.is_same(id, imitator, key)).map(cost);
            (own - costs.fold(f64::INFINITY, f64::min)).min(0.0).exp()
        };
        1.0 / (1.0 + self.imitators(id).into_iter().map(odds).sum::<f64>())
    }

    /// Whether an imitator has an effect as a special case, and the model with it in its place lowers
    /// the misfit no further than chance does.
    fn is_same(&self, id: &'static str, imitator: &'static str, with_imitator: &Key) -> bool {
        let Self { models, chosen } = self;
        let effects = models.effect(id).zip(models.effect(imitator));
        let contains = effects.is_some_and(|(own, other)| is_special_case(own, other));
        let misfit = |key| models.criterion(key) - models.complexity(key);
        contains && misfit(chosen) - misfit(with_imitator) < CHANCE_GAIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{fitted_to, key};

    fn confidence(models: &Models, chosen: &Key, id: &'static str, fits: bool) -> f64 {
        Standing { models, chosen }.confidence(id, fits)
    }

    // The noise accounts for 100 of each cost: the factors are 50 and 2.
    #[test]
    fn an_effect_without_which_much_more_is_left_is_sure_and_another_is_not() {
        let sure = fitted_to(&[(&["spring"], 300.0), (&["friction_drift"], 10_100.0)]);
        assert!(confidence(&sure, &key(&["spring"]), "spring", false) > 0.95);
        let doubtful = fitted_to(&[(&["spring"], 300.0), (&["friction_drift"], 500.0)]);
        let doubt = confidence(&doubtful, &key(&["spring"]), "spring", false);
        assert!((LEAST..0.4).contains(&doubt), "{doubt}");
    }

    #[test]
    fn closest_imitators_stand_out_together_and_share_the_confidence() {
        let costs = |lag: f64| {
            let models = fitted_to(&[
                (&["transport_delay"], 300.0),
                (&["sensor_lag"], lag),
                (&["spring"], 10_100.0),
            ]);
            confidence(&models, &key(&["transport_delay"]), "transport_delay", false)
        };
        let (near, far) = (costs(300.0), costs(500.0));
        assert!((0.2..0.8).contains(&near), "{near}");
        assert!(far > 0.9, "{far}");
    }

    #[test]
    fn backlash_is_a_flexible_mode_where_its_gap_does_not_show_and_no_other_imitator_is() {
        let models =
            fitted_to(&[(&["flexible_mode"], 300.0), (&["backlash"], 299.5), (&["spring"], 299.5)]);
        let is_same = |one: &'static str, other: &'static str| {
            Standing { models: &models, chosen: &key(&[one]) }.is_same(one, other, &key(&[other]))
        };
        assert!(is_same("flexible_mode", "backlash"));
        assert!(!is_same("backlash", "flexible_mode"), "the general case is no special one");
        assert!(!is_same("flexible_mode", "spring"));
        let shown = fitted_to(&[(&["flexible_mode"], 300.0), (&["backlash"], 150.0)]);
        let shared = confidence(&shown, &key(&["flexible_mode"]), "flexible_mode", false);
        assert!(shared < 0.6, "{shared}");
    }

    #[test]
    fn where_one_effect_leaves_only_noise_its_posterior_probability_counts() {
        let models = fitted_to(&[(&["spring"], 100.0), (&["friction_drift"], 160.0)]);
        let sure = confidence(&models, &key(&["spring"]), "spring", true);
        assert_eq!(sure, models.probability(|id| id == "spring"));
    }
}
