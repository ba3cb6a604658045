//! Rows of what came of jobs: results, and the history of convergence.

use super::Millis;

/// One row of convergence history.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergencePoint {
    /// Position within the history of the job over all its attempts, from 0.
    pub seq: i64,
    /// Stage of the computation.
    pub stage: String,
    /// Epoch, cycle or step within the stage.
    pub cycle: i64,
    /// Evaluations used by the stage.
    pub evaluations: i64,
    /// Best cost; finite.
    pub best: f64,
    /// Mean cost over the population.
    pub mean: Option<f64>,
    /// Seconds since the computation began.
    pub elapsed_s: f64,
}

/// Which results to list; `None` accepts every value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ResultFilter {
    /// The machine.
    pub machine: Option<String>,
    /// The axis.
    pub axis: Option<String>,
    /// The measurement.
    pub measurement_id: Option<String>,
    /// Measured at this time or later; stored, where the upload does not say when.
    pub from_ms: Option<Millis>,
    /// Measured before this time, likewise.
    pub to_ms: Option<Millis>,
    /// Of each measurement only the job that was submitted last.
    pub latest_only: bool,
}

/// A result with what it is of.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredResult {
    /// The job.
    pub job_id: String,
    /// JSON of the result.
    pub result: String,
    /// The measurement.
    pub measurement_id: String,
    /// Its name.
    pub name: Option<String>,
    /// Its machine.
    pub machine: Option<String>,
    /// Its axis.
    pub axis: Option<String>,
    /// When it was measured; where the upload does not say, when it was stored.
    pub at_ms: Millis,
}

/// An axis that measurements name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxisRow {
    /// The machine.
    pub machine: String,
    /// The axis.
    pub axis: String,
    /// Measurements of it.
    pub measurements: i64,
    /// Those of them with a result.
    pub results: i64,
    /// When it was first measured; stored, where the upload does not say when.
    pub first_ms: Millis,
    /// When it was last measured.
    pub last_ms: Millis,
}
