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
    pub fn stage(&self, name: &'static str, total: usize) -> Stage<'a> {
        let stage = Stage { part: *self, name, total: total as u64, done: Mutex::new(0) };
        stage.report(0);
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

/// An observer whose fraction never decreases: a search does not know beforehand how often it
/// repeats a stage, and a stage that is repeated begins at its old share again.
pub(super) struct Forward<'a> {
    whole: &'a dyn Observer,
    reached: Mutex<f64>,
}

impl<'a> Forward<'a> {
    pub fn new(whole: &'a dyn Observer) -> Self {
        Self { whole, reached: Mutex::new(0.0) }
    }
}

impl Observer for Forward<'_> {
    fn elapsed_s(&self) -> f64 {
        self.whole.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        // The lock is held while reporting, so that fractions arrive in order.
        let mut reached = self.reached.lock().unwrap_or_else(PoisonError::into_inner);
        *reached = reached.max(progress.fraction);
        self.whole.progress(Progress { fraction: *reached, ..progress });
    }

    fn row(&self, row: ConvergenceRow) {
        self.whole.row(row);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
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
    name: &'static str,
    total: u64,
    done: Mutex<u64>,
}

impl Stage<'_> {
    /// Counts one finished step and reports it.
    pub fn step(&self) {
        // The lock is held while reporting, so that counts arrive in order.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        self.report(*done);
    }

    fn report(&self, done: u64) {
        let fraction = done as f64 / self.total.max(1) as f64;
        self.part.progress(Progress { stage: self.name.into(), done, total: self.total, fraction });
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
    fn the_fraction_stays_where_a_stage_is_repeated() {
        let log = Log::default();
        let forward = Forward::new(&log);
        let part = Part { whole: &forward, span: [0.2, 0.6] };
        for _ in 0..2 {
            part.stage("further starts", 1).step();
        }
        let fractions: Vec<f64> = log.0.lock().unwrap().iter().map(|seen| seen.1).collect();
        assert_eq!(fractions, [0.2, 0.6, 0.6, 0.6]);
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
}
