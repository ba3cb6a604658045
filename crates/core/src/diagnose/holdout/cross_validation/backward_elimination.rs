//! Backward elimination of effects that do not improve the predictions of held-out data.

use super::CrossValidation;
use crate::answers::Gain;
use crate::diagnose::selection::models::{Key, Models};

/// An effect that does not improve the predictions of the other effects.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dropped {
    /// Its id.
    pub id: &'static str,
    /// The other effects of the model.
    pub beside: Key,
    /// Its gain beside them.
    pub gain: Gain,
}

impl CrossValidation {
    /// Backward elimination by held-out error: drops effects that do not certainly help the others
    /// predict, the one of smallest gain first, until one is left. That one was the best beside
    /// others and need not be the best alone: it gives way to a better supported single effect of
    /// `models` that was not dropped.
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
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::cross_validation;
    use crate::diagnose::selection::familywise_threshold::FamilywiseThreshold;
    use crate::diagnose::tests::fitted_to;

    #[test]
    fn an_effect_that_adds_nothing_to_the_others_is_dropped() {
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
        // The errors are 0.11 with it and 0.1 without.
        assert!((dropped[0].gain.ratio - 1.0 / 1.1).abs() < 1e-12, "{dropped:?}");
    }

    // Beside a spring, backlash fits better than the flexible mode does; alone it fits worse.
    #[test]
    fn a_single_remaining_effect_is_replaced_by_a_better_single_one() {
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
        models.family = Some(FamilywiseThreshold::with_low_limits(&["backlash", "flexible_mode"]));
        let mut effects = vec!["backlash", "spring"];
        let dropped = cross_validation.prune(&models, &mut effects);
        assert_eq!((dropped[0].id, effects), ("spring", vec!["flexible_mode"]));
        assert_eq!(dropped[0].beside, ["backlash"]);
    }

    #[test]
    fn the_last_effect_is_never_dropped_nor_one_whose_gain_is_unknown() {
        let models = fitted_to(&[]);
        let mut effects = vec!["spring"];
        assert!(cross_validation(&[(&["spring"], 0.9)]).prune(&models, &mut effects).is_empty());
        let mut effects = vec!["cogging", "spring"];
        let unfitted = cross_validation(&[(&["cogging", "spring"], 0.9)]);
        assert!(unfitted.prune(&models, &mut effects).is_empty());
        assert_eq!(effects.len(), 2);
    }
}
