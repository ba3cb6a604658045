//! The identification methods: one file for each, one entry in the list [`METHODS`].
//!
//! A method is defined by the stages it has. They run in this order, each starting from what the
//! previous ones found: closed form, network, search, refinement. Options can disable the stages of
//! a method but cannot add any.

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
