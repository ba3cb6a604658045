//! Progress reports from a computation, and its cancellation.

mod remaining_time;
mod steady;

use crate::answers::{ConvergenceRow, Progress};

pub(crate) use steady::Steady;

/// Watches a computation from outside the numeric core.
///
/// The core has no clock, log or runtime of its own, so it gets the time, reports its progress and
/// learns of a cancellation through this trait. The computing threads call the methods often, so
/// they must be fast.
pub trait Observer: Sync {
    /// Seconds since the computation began, by the observer's clock.
    fn elapsed_s(&self) -> f64 {
        0.0
    }

    /// Called whenever the computation has advanced.
    fn progress(&self, _progress: Progress) {}

    /// Called when the rest of the computation is certain: before, what is found decides what else
    /// is computed, so that nobody knows how much is left. From here on the fraction grows about as
    /// time does. It is called again where that begins anew.
    fn rest_is_certain(&self) {}

    /// Called with each new row of the convergence history.
    fn row(&self, _row: ConvergenceRow) {}

    /// Called before every simulation of an experiment; once it has returned `true` it must go on
    /// doing so. The computation then ends with an error that says it was cancelled.
    fn cancelled(&self) -> bool {
        false
    }
}

/// An observer that ignores all reports and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {}
