//! Predictions of held-out data that are wrong by a known amount.

use std::collections::BTreeMap;

use super::CrossValidation;
use crate::answers::ComparedHarmonic;
use crate::diagnose::holdout::heldout_predictions::Predicted;

/// Predictions of twelve groups of one row each, wrong by about `by`, and by `spread` of it more or
/// less from group to group.
pub(super) fn off(by: f64, spread: f64) -> Predicted {
    let harmonic = |group: usize| ComparedHarmonic {
        order: 1,
        input: [1.0, 0.0],
        measured: [1.0, 0.0],
        simulated: [1.0 - by * (1.0 + spread * (group as f64).sin()), 0.0],
        std: 0.1,
    };
    (0..12).map(|group| ((group, 1), harmonic(group))).collect()
}

/// The base model is wrong by 0.5, models with effects by their amounts.
pub(super) fn cross_validation(by_effects: &[(&[&'static str], f64)]) -> CrossValidation {
    let by_effects = by_effects.iter().map(|(key, by)| (key.to_vec(), off(*by, 0.05)));
    CrossValidation {
        base: off(0.5, 0.05),
        chosen: Predicted::new(),
        by_effects: by_effects.collect(),
        errors: BTreeMap::new(),
        choices: Vec::new(),
        groups: (0..12).map(|group| ((group, 1), group)).collect(),
        noise_known: false,
        what: String::new(),
    }
}
