//! Progress reports: maps the progress of each part of a diagnosis to a share of the whole.

use std::sync::{Mutex, PoisonError};

use crate::answers::{ConvergenceRow, Progress};
use crate::observer::Observer;

/// A part of a diagnosis that reports its own progress from 0 to 1.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// The observer of the whole diagnosis.
    pub whole: &'a dyn Observer,
    /// Fractions of the whole at which the part begins and ends.
    pub span: [f64; 2],
}

impl<'a> Part<'a> {
    /// A part of this part; `span` are fractions of this part.
    pub fn part(&self, span: [f64; 2]) -> Part<'a> {
        let [begin, end] = self.span;
        Part { whole: self.whole, span: span.map(|share| begin + share * (end - begin)) }
    }

    /// Begins a stage of `total` steps and reports it.
    pub fn stage(&self, name: impl Into<String>, total: usize) -> Stage<'a> {
        let (name, total) = (name.into(), total as u64);
        let stage =
            Stage { part: *self, name, total, done: Mutex::new(Done { steps: 0, begun: 0.0 }) };
        stage.advance(0, 0.0);
        stage
    }
}

impl Observer for Part<'_> {
    fn elapsed_s(&self) -> f64 {
        self.whole.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        let [begin, end] = self.span;
        let fraction = begin + (end - begin) * progress.fraction;
        self.whole.progress(Progress { fraction, ..progress });
    }

    fn row(&self, row: ConvergenceRow) {
        self.whole.row(row);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}

/// The rest of a span whose number of steps is not known beforehand.
pub(super) struct Remaining<'a>(pub Part<'a>);

impl<'a> Remaining<'a> {
    /// Takes a share of the rest.
    pub fn take(&mut self, share: f64) -> Part<'a> {
        let taken = self.0.part([0.0, share]);
        self.0 = self.0.part([share, 1.0]);
        taken
    }
}

/// A number of effects in words, for the names of stages.
pub(super) fn effects_in_words(count: usize) -> String {
    match count {
        1 => "one effect".into(),
        2 => "two effects".into(),
        3 => "three effects".into(),
        _ => format!("{count} effects"),
    }
}

/// An observer that passes on cancellation but reports no progress.
pub(super) struct Quiet<'a>(pub &'a dyn Observer);

impl Observer for Quiet<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// A stage of equal steps that several threads may do.
pub(super) struct Stage<'a> {
    part: Part<'a>,
    name: String,
    total: u64,
    done: Mutex<Done>,
}

/// What is done of a stage.
struct Done {
    /// Finished steps.
    steps: u64,
    /// Shares of steps that are not finished, together.
    begun: f64,
}

/// Share of the rest of a step that each of its own steps is reckoned to take: their number is not
/// known beforehand. A fit takes some ten or twenty.
const SHARE_OF_REST: f64 = 0.1;

impl Stage<'_> {
    /// Counts one finished step and reports it.
    pub fn step(&self) {
        self.begin().finish();
    }

    /// Begins a step that takes long, and whose own progress counts.
    pub fn begin(&self) -> Step<'_> {
        Step { stage: self, done: Mutex::new(0.0) }
    }

    fn advance(&self, steps: u64, share: f64) {
        // The lock is held while reporting, so that counts arrive in order.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        done.steps += steps;
        done.begun += share;
        self.report(&done);
    }

    fn report(&self, done: &Done) {
        let fraction = (done.steps as f64 + done.begun) / self.total.max(1) as f64;
        let (stage, done, total) = (self.name.clone(), done.steps, self.total);
        self.part.progress(Progress { stage, done, total, fraction, remaining_s: None });
    }
}

/// A step of a stage while it is being done, by several threads perhaps.
pub(super) struct Step<'a> {
    stage: &'a Stage<'a>,
    /// The share of it that is done.
    done: Mutex<f64>,
}

impl Step<'_> {
    /// Reports that it has advanced.
    pub fn advance(&self) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let share = SHARE_OF_REST * (1.0 - *done);
        *done += share;
        self.stage.advance(0, share);
    }

    /// Reports that it is done.
    pub fn finish(self) {
        let done = self.done.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.stage.advance(1, -done);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Log(Mutex<Vec<(u64, f64)>>);

    impl Observer for Log {
        fn progress(&self, progress: Progress) {
            self.0.lock().unwrap().push((progress.done, progress.fraction));
        }
    }

    #[test]
    fn the_steps_of_a_part_are_shares_of_the_whole() {
        let log = Log::default();
        let whole = Part { whole: &log, span: [0.2, 0.6] };
        let stage = whole.part([0.5, 1.0]).stage("candidates", 2);
        stage.step();
        stage.step();
        let seen = log.0.lock().unwrap().clone();
        for (seen, wanted) in seen.iter().zip([(0, 0.4), (1, 0.5), (2, 0.6)]) {
            assert_eq!(seen.0, wanted.0);
            assert!((seen.1 - wanted.1).abs() < 1e-12, "{seen:?}");
        }
    }

    // A tenth of the step, a tenth of the rest, and then all of it.
    #[test]
    fn a_long_step_counts_while_it_is_done() {
        let log = Log::default();
        let whole = Part { whole: &log, span: [0.0, 1.0] };
        let stage = whole.stage("full fits", 2);
        let step = stage.begin();
        step.advance();
        step.advance();
        step.finish();
        let seen = log.0.lock().unwrap().clone();
        for (seen, wanted) in seen.iter().zip([(0, 0.0), (0, 0.05), (0, 0.095), (1, 0.5)]) {
            assert_eq!(seen.0, wanted.0);
            assert!((seen.1 - wanted.1).abs() < 1e-12, "{seen:?}");
        }
    }
}
