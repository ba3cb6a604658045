//! Methods that only comparisons need: the other searches of the paper, and CMA-ES.
//!
//! One file a method, one line in the list [`METHODS`]. A program that offers them passes the list
//! with its requests.

mod aga_ann;
mod cma_es;
mod ga_ann;
mod genetic;
#[cfg(test)]
mod tests;

use servoscope_core::answers::Method;
use servoscope_core::identify::Methods;

/// These methods beside those of `servoscope-core`.
pub const METHODS: Methods = Methods {
    further: &[
        (Method::AgaAnn, aga_ann::STEPS),
        (Method::GaAnn, ga_ann::STEPS),
        (Method::CmaEs, cma_es::STEPS),
    ],
};
