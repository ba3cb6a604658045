//! Progress and convergence history of an identification.

use crate::answers::{ConvergenceRow, Progress, Stage};
use crate::observer::Observer;
use crate::plant::Plant;

use super::parameter_names;
use super::request::IdentifyError;

/// Stages by name, and the fractions of a run at which each begins and ends, for the progress bar.
/// Searches without earlier stages begin at 0.
const STAGE_SHARES: [(&str, f64, f64); 10] = [
    ("closed_form", 0.0, 0.02),
    ("network", 0.02, 0.45),
    ("colony", 0.45, 0.85),
    ("swarm", 0.45, 0.85),
    ("genetic", 0.45, 0.85),
    ("adaptive_genetic", 0.45, 0.85),
    ("descents", 0.0, 0.85),
    ("evolution", 0.0, 0.85),
    ("refinement", 0.85, 1.0),
    ("refit", 0.0, 1.0),
];

/// Reports one run of a method to its observer.
pub(super) struct History<'a> {
    /// The observer.
    pub observer: &'a dyn Observer,
    /// The actuator order being fitted.
    pub order: u8,
    /// Number of orders fitted before this one, and number of orders in all. With several orders,
    /// the names of stages contain the order.
    pub orders: (usize, usize),
}

/// A stage in progress.
pub(super) struct RunningStage<'h> {
    history: &'h History<'h>,
    stage: &'static str,
    begun_s: f64,
    total: u64,
    budget: Option<u64>,
}

impl History<'_> {
    /// Begins a stage of `total` steps.
    pub fn begin(&self, stage: &'static str, total: u64) -> RunningStage<'_> {
        let begun = RunningStage {
            history: self,
            stage,
            begun_s: self.observer.elapsed_s(),
            total,
            budget: None,
        };
        begun.progress(0);
        begun
    }

    /// Whether the run may go on.
    ///
    /// # Errors
    /// When the observer has cancelled it.
    pub fn check_cancelled(&self) -> Result<(), IdentifyError> {
        if self.observer.cancelled() { Err(IdentifyError::Cancelled) } else { Ok(()) }
    }

    fn name(&self, stage: &str) -> String {
        match self.orders {
            (_, 1) => stage.to_owned(),
            _ => format!("{stage} (order {})", self.order),
        }
    }
}

impl<'h> RunningStage<'h> {
    /// Sets the number of evaluations that the stage may use.
    pub fn within(self, budget: u64) -> RunningStage<'h> {
        RunningStage { budget: Some(budget), ..self }
    }

    /// Reports that `done` steps are done.
    pub fn progress(&self, done: u64) {
        let (_, begin, end) = STAGE_SHARES
            .iter()
            .find(|(name, ..)| *name == self.stage)
            .expect("a stage that is listed");
        let share = begin + (end - begin) * done as f64 / self.total.max(1) as f64;
        let (before, all) = self.history.orders;
        self.history.observer.progress(Progress {
            stage: self.history.name(self.stage),
            done,
            total: self.total,
            fraction: (before as f64 + share) / all as f64,
        });
    }

    /// Reports one row of the convergence history.
    pub fn row(&self, cycle: u64, evaluations: u64, best: f64, mean: Option<f64>) {
        let observer = self.history.observer;
        observer.row(ConvergenceRow {
            stage: self.history.name(self.stage),
            cycle,
            evaluations,
            // The history is stored as JSON, which has no infinity.
            best: best.min(f64::MAX),
            mean,
            elapsed_s: observer.elapsed_s(),
        });
    }

    /// Ends the stage at a plant (in units of the upload).
    pub fn end(&self, evaluations: u64, cost: f64, plant: &Plant, stop_reason: &str) -> Stage {
        Stage {
            name: self.history.name(self.stage),
            evaluations,
            budget: self.budget,
            seconds: self.history.observer.elapsed_s() - self.begun_s,
            cost,
            parameters: parameter_names::values(plant),
            stop_reason: stop_reason.to_owned(),
        }
    }
}
