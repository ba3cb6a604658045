//! Progress and convergence history of a running computation.

use serde::{Deserialize, Serialize};

/// Progress of a computation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Progress {
    /// What is being computed, in words.
    pub stage: String,
    /// Steps of the stage that are done.
    pub done: u64,
    /// Upper bound on the steps of the stage.
    pub total: u64,
    /// Share of the whole computation that is done, 0 to 1. It never decreases.
    pub fraction: f64,
    /// Estimate of the time left when this was reported, seconds; null while it is not known to
    /// within a factor of two.
    #[serde(default)]
    pub remaining_s: Option<f64>,
}

/// One row of convergence history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ConvergenceRow {
    /// Stage the row belongs to.
    pub stage: String,
    /// Epoch, cycle or step within the stage.
    pub cycle: u64,
    /// Simulations of the whole measurement that the stage has used so far.
    pub evaluations: u64,
    /// Best cost so far: noise-weighted misfit (χ²), or the loss of the network.
    pub best: f64,
    /// Mean cost over the population, if the stage has one.
    pub mean: Option<f64>,
    /// Seconds since the computation began.
    pub elapsed_s: f64,
}
