//! The stages that a method may have.

use crate::identify::optimiser::Optimiser;

/// The stages of a method.
pub(in super::super) struct Steps {
    /// Whether it has a closed-form start, computed from the data alone.
    pub closed_form: bool,
    /// Whether it has a network that proposes parameters from measured features.
    pub network: bool,
    /// The search; `None` if the closed form is the answer.
    pub search: Option<&'static dyn Optimiser>,
    /// Whether Levenberg–Marquardt refines the best points found.
    pub refinement: bool,
}
