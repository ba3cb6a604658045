//! Models that predict held-out data about as well as the chosen one.
//!
//! Where every model leaves more than noise, its residual is not independent from datum to datum, and
//! the likelihood makes too much of a small difference between two models. What is left of such a
//! difference shows in data that neither has seen. Of the models among which these data do not decide,
//! the one of fewest parameters is taken (L. Breiman, J. H. Friedman, R. A. Olshen, C. J. Stone 1984,
//! Classification and Regression Trees, section 3.4.3, with an interval of 95 % in place of one
//! standard error).

use std::collections::BTreeSet;

use super::{CrossValidation, Predicted, gain};
use crate::diagnose::selection::models::{Key, Models};

/// Whether a model has as many effects as another, and all of them but one.
pub(super) fn differs_by_one(key: &Key, other: &Key) -> bool {
    let shared = key.iter().filter(|id| other.contains(id)).count();
    key.len() == other.len() && shared + 1 == key.len()
}

impl CrossValidation {
    /// Puts a simpler model in place of `chosen`, if there is one:
    ///
    /// - the one that predicts held-out data best among those with fewer effects that predict them at
    ///   least as well;
    /// - the one of fewest parameters among those with one other effect that it does not certainly
    ///   surpass. Of as many parameters the one of more evidence stays.
    pub fn simplify(&self, models: &Models, chosen: &mut Key) {
        if let Some(fewer) = self.with_fewer_effects(models, chosen) {
            *chosen = fewer;
        }
        let size = |key: &Key| models.get(key).map_or(usize::MAX, |model| model.parameters());
        let alike = self.alike(models, chosen).into_iter().filter(|key| size(key) < size(chosen));
        let order = |a: &Key, b: &Key| {
            let by_evidence = || models.criterion(a).total_cmp(&models.criterion(b));
            size(a).cmp(&size(b)).then_with(by_evidence)
        };
        if let Some(simplest) = alike.min_by(order) {
            *chosen = simplest;
        }
    }

    /// The supported model that predicts best among those with fewer effects that predict at least as
    /// well.
    fn with_fewer_effects(&self, models: &Models, chosen: &Key) -> Option<Key> {
        let own = gain::error(self.by_effects.get(chosen)?)?;
        let fewer = self.by_effects.iter().filter(|(key, _)| key.len() < chosen.len());
        let errors = fewer
            .filter(|(key, _)| models.supported(key))
            .filter_map(|(key, predicted)| Some((gain::error(predicted)?, key)));
        let best = errors.min_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(error, _)| *error <= own).map(|(_, key)| key.clone())
    }

    /// The supported models with another effect in place of one of `chosen`, which does not
    /// certainly predict held-out data better.
    pub fn alike(&self, models: &Models, chosen: &Key) -> BTreeSet<Key> {
        let Some(own) = self.by_effects.get(chosen) else { return BTreeSet::new() };
        let others = self.by_effects.iter().filter(|(key, _)| differs_by_one(key, chosen));
        let is_alike = |(key, predicted): &(&Key, &Predicted)| {
            let lead = self.between(predicted, own);
            models.supported(key) && lead.is_some_and(|lead| lead.interval95[0] <= 1.0)
        };
        others.filter(is_alike).map(|(key, _)| key.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cross_validation, off};
    use super::*;
    use crate::diagnose::selection::familywise_threshold::FamilywiseThreshold;
    use crate::diagnose::tests::{fitted_to, key};

    const IDS: [&str; 4] = ["backlash", "cogging", "spring", "viscous_asymmetry"];

    /// Backlash is off by 0.1 and fits best; a spring predicts about as well, in some groups better
    /// and in others worse; viscous asymmetry predicts certainly worse; cogging is as good but may be chance.
    fn of_four() -> (CrossValidation, Models) {
        let ids = IDS.map(|id| [id]);
        let errors = ids.each_ref().map(|id| (id.as_slice(), 0.1));
        let mut cross_validation = cross_validation(&errors);
        cross_validation.by_effects.insert(key(&["spring"]), off(0.101, -0.4));
        cross_validation.by_effects.insert(key(&["viscous_asymmetry"]), off(0.2, 0.05));
        let costs =
            ids.each_ref().map(|id| id.as_slice()).into_iter().zip([200.0, 210.0, 220.0, 230.0]);
        let mut models = fitted_to(&costs.collect::<Vec<_>>());
        let likely = ["backlash", "spring", "viscous_asymmetry"];
        models.family = Some(FamilywiseThreshold::with_low_limits(&likely));
        (cross_validation, models)
    }

    #[test]
    fn of_models_that_held_out_data_do_not_tell_apart_the_one_of_fewest_parameters_is_taken() {
        let (cross_validation, models) = of_four();
        let mut chosen = key(&["backlash"]);
        cross_validation.simplify(&models, &mut chosen);
        assert_eq!(chosen, ["spring"]);
        cross_validation.simplify(&models, &mut chosen);
        assert_eq!(chosen, ["spring"], "backlash has more parameters");
    }

    #[test]
    fn a_single_effect_that_predicts_at_least_as_well_takes_the_place_of_two() {
        let (mut cross_validation, models) = of_four();
        let pair = key(&["cogging", "viscous_asymmetry"]);
        for (error, simpler) in [(0.099, false), (0.1, true)] {
            cross_validation.by_effects.insert(pair.clone(), off(error, 0.05));
            let found = cross_validation.with_fewer_effects(&models, &pair);
            assert_eq!(found, simpler.then(|| key(&["backlash"])));
        }
    }

    #[test]
    fn alike_are_supported_models_that_do_not_certainly_predict_worse() {
        let (cross_validation, models) = of_four();
        let alike = |id| cross_validation.alike(&models, &key(&[id]));
        assert_eq!(alike("backlash"), BTreeSet::from([key(&["spring"])]));
        assert_eq!(alike("spring"), BTreeSet::from([key(&["backlash"])]));
        assert!(alike("viscous_asymmetry").contains(&key(&["spring"])));
        assert!(alike("sensor_lag").is_empty(), "it was not fitted");
    }

    #[test]
    fn models_differ_by_one_effect_where_they_share_all_others() {
        let differ =
            |one: &[&'static str], other: &[&'static str]| differs_by_one(&key(one), &key(other));
        assert!(differ(&["spring"], &["backlash"]));
        assert!(differ(&["cogging", "spring"], &["backlash", "cogging"]));
        assert!(!differ(&["cogging", "spring"], &["cogging", "spring"]));
        assert!(!differ(&["cogging", "spring"], &["spring"]));
        assert!(!differ(&["cogging", "spring"], &["backlash", "stribeck"]));
    }
}
