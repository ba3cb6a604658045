//! Progress and convergence history of an identification.

use crate::answers::{ConvergenceRow, Progress, Stage};
use crate::observer::Observer;
use crate::plant::Plant;

use super::parameter_names;
use super::request::IdentifyError;

/// A stage as the progress shows it.
struct Shown {
    /// Its name in the history and in answers.
    name: &'static str,
    /// What it does, in words.
    words: &'static str,
    /// Fractions of a run at which it begins and ends. Searches without earlier stages begin at 0.
    span: [f64; 2],
}

const fn shown(name: &'static str, words: &'static str, span: [f64; 2]) -> Shown {
    Shown { name, words, span }
}

/// Every stage.
const STAGES: [Shown; 10] = [
    shown("closed_form", "first estimate", [0.0, 0.02]),
    shown("network", "training a neural network", [0.02, 0.4]),
    shown("colony", "searching with a bee colony", [0.4, 0.75]),
    shown("swarm", "searching with a particle swarm", [0.4, 0.75]),
    shown("genetic", "searching with a genetic algorithm", [0.4, 0.75]),
    shown("adaptive_genetic", "searching with a genetic algorithm", [0.4, 0.75]),
    shown("descents", "fitting from several starts", [0.0, 0.75]),
    shown("evolution", "searching with an evolution strategy", [0.0, 0.75]),
    shown("refinement", "refining the fit", [0.75, 1.0]),
    shown("refit", "refining the fit", [0.0, 1.0]),
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
        let shown = STAGES.iter().find(|shown| shown.name == self.stage);
        let Shown { words, span: [begin, end], .. } = shown.expect("a stage that is listed");
        let share = begin + (end - begin) * done as f64 / self.total.max(1) as f64;
        let (before, all) = self.history.orders;
        let stage = match all {
            1 => (*words).to_owned(),
            _ => format!("{words}, actuator of order {}", self.history.order),
        };
        self.history.observer.progress(Progress {
            stage,
            done,
            total: self.total,
            fraction: (before as f64 + share) / all as f64,
            remaining_s: None,
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
