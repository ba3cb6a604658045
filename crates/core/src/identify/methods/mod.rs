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
pub(super) mod steps;
#[cfg(test)]
mod tests;
mod two_magnitude;

use crate::answers::Method;

use steps::Steps;

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
