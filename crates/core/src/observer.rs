//! How a computation reports on itself and learns that it is no longer wanted.

use crate::answers::{ConvergenceRow, Progress};

/// Watches a computation from outside the numeric core.
///
/// The core has no clock, no log and no runtime: time, storage and cancellation
/// come from here. Methods are called from the thread that computes, often.
pub trait Observer: Sync {
    /// Seconds since the computation began, by the observer's clock.
    fn elapsed_s(&self) -> f64 {
        0.0
    }

    /// The computation has come this far.
    fn progress(&self, _progress: Progress) {}

    /// One more row of convergence history.
    fn row(&self, _row: ConvergenceRow) {}

    /// Asked at every evaluation; `true` ends the computation with an error
    /// that says it was cancelled.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {}
