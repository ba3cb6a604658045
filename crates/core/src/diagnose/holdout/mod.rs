//! Cross-validation: how well models predict data that no fit has seen.

pub(super) mod cross_validation;
pub(super) mod cv_splits;
pub(super) mod gain;
pub(super) mod heldout_predictions;
