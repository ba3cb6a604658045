//! The stages that a method may have.

use crate::identify::optimiser::Optimiser;

/// Stages of a method.
pub(in super::super) struct Steps {
    /// A start from the data alone.
    pub closed_form: bool,
    /// A network that proposes from measured features.
    pub network: bool,
    /// The search; `None`: the closed form is the answer.
    pub search: Option<&'static dyn Optimiser>,
    /// Levenberg–Marquardt from the best that was found.
    pub refinement: bool,
}
