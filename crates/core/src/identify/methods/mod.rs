//! The methods: one file a method, one line in the list [`METHODS`].
//!
//! A method is the stages it has. They run in this order, each handing on what it found:
//! closed form, network, search, refinement. Which of them run is up to the options too; a stage
//! that a method lacks does not run whatever they say.

mod abc_ann;
mod aga_ann;
mod cma_es;
mod ga_ann;
mod genetic;
mod least_squares;
mod pso_ann;
#[cfg(test)]
mod tests;
mod two_magnitude;

use crate::answers::Method;

use super::optimiser::Optimiser;

/// Stages of a method.
pub(super) struct Steps {
    /// A start from the data alone.
    pub closed_form: bool,
    /// A network that proposes from measured features.
    pub network: bool,
    /// The search; `None`: the closed form is the answer.
    pub search: Option<&'static dyn Optimiser>,
    /// Levenberg–Marquardt from the best that was found.
    pub refinement: bool,
}

/// Every method and its stages.
const METHODS: &[(Method, &Steps)] = &[
    (Method::AbcAnn, &abc_ann::STEPS),
    (Method::PsoAnn, &pso_ann::STEPS),
    (Method::AgaAnn, &aga_ann::STEPS),
    (Method::GaAnn, &ga_ann::STEPS),
    (Method::TwoMagnitude, &two_magnitude::STEPS),
    (Method::LeastSquares, &least_squares::STEPS),
    (Method::CmaEs, &cma_es::STEPS),
];

/// The stages of a method.
pub(super) fn steps(method: Method) -> &'static Steps {
    let found = METHODS.iter().find(|(known, _)| *known == method);
    found.expect("every method is listed: a test tries them all").1
}
