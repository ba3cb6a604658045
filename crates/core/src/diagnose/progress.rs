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
    /// Whether nothing follows it that has still to be decided.
    pub last: bool,
}

impl<'a> Part<'a> {
    /// The whole.
    pub const fn of(whole: &'a dyn Observer) -> Part<'a> {
        Part { whole, span: [0.0, 1.0], last: true }
    }

    /// A part of this part; `span` are fractions of this part.
    pub fn part(&self, span: [f64; 2]) -> Part<'a> {
        let [begin, end] = self.span;
        Part {
            span: span.map(|share| begin + share * (end - begin)),
            last: self.last && span[1] == 1.0,
            ..*self
        }
    }

    /// Begins a stage of `total` steps and reports it.
    pub fn stage(&self, name: impl Into<String>, total: usize) -> Stage<'a> {
        self.weighted_stage(name, total, total as f64)
    }

    /// Begins a stage of `total` steps that take different times: those of all steps together are
    /// `all`, in any unit.
    pub fn weighted_stage(&self, name: impl Into<String>, total: usize, all: f64) -> Stage<'a> {
        let (name, total) = (name.into(), total as u64);
        let done = Mutex::new(Done { steps: 0, work: 0.0 });
        let stage = Stage { part: *self, name, total, all, done };
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

    fn rest_is_certain(&self) {
        self.whole.rest_is_certain();
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
    /// Number of steps.
    total: u64,
    /// How long all of them take, in units of one.
    all: f64,
    done: Mutex<Done>,
}

/// What is done of a stage.
struct Done {
    /// Finished steps.
    steps: u64,
    /// How long what is done took, in units of `Stage::all`.
    work: f64,
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
        self.begin_weighted(1.0)
    }

    /// The same with its share of the work of the stage.
    pub fn begin_weighted(&self, weight: f64) -> Step<'_> {
        Step { stage: self, weight, done: Mutex::new(0.0) }
    }

    fn advance(&self, steps: u64, work: f64) {
        // The lock is held while reporting, so that counts arrive in order.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        done.steps += steps;
        done.work += work;
        self.report(&done);
    }

    fn report(&self, done: &Done) {
        let all = if self.all > 0.0 { self.all } else { 1.0 };
        let fraction = (done.work / all).clamp(0.0, 1.0);
        let (stage, done, total) = (self.name.clone(), done.steps, self.total);
        self.part.progress(Progress { stage, done, total, fraction, remaining_s: None });
    }
}

/// A step of a stage while it is being done, by several threads perhaps.
pub(super) struct Step<'a> {
    stage: &'a Stage<'a>,
    /// How long it takes, in units of `Stage::all`.
    weight: f64,
    /// The share of it that is done.
    done: Mutex<f64>,
}

impl Step<'_> {
    /// Reports that it has advanced.
    pub fn advance(&self) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let share = SHARE_OF_REST * (1.0 - *done);
        *done += share;
        self.stage.advance(0, share * self.weight);
    }

    /// Reports that it is done.
    pub fn finish(self) {
        let done = self.done.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.stage.advance(1, self.weight * (1.0 - done));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Silent;

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
        let whole = Part::of(&log).part([0.2, 0.6]);
        let stage = whole.part([0.5, 1.0]).stage("candidates", 2);
        stage.step();
        stage.step();
        let seen = log.0.lock().unwrap().clone();
        for (seen, wanted) in seen.iter().zip([(0, 0.4), (1, 0.5), (2, 0.6)]) {
            assert_eq!(seen.0, wanted.0);
            assert!((seen.1 - wanted.1).abs() < 1e-12, "{seen:?}");
        }
    }

    #[test]
    fn a_step_of_more_work_counts_more() {
        let log = Log::default();
        let stage = Part::of(&log).weighted_stage("full fits", 2, 4.0);
        let long = stage.begin_weighted(3.0);
        long.advance();
        stage.begin_weighted(1.0).finish();
        long.finish();
        let seen = log.0.lock().unwrap().clone();
        for (seen, wanted) in seen.iter().zip([(0, 0.0), (0, 0.075), (1, 0.325), (2, 1.0)]) {
            assert_eq!(seen.0, wanted.0);
            assert!((seen.1 - wanted.1).abs() < 1e-12, "{seen:?}");
        }
    }

    #[test]
    fn the_last_part_of_the_last_part_is_the_last() {
        let whole = Part::of(&Silent);
        assert!(whole.last && whole.part([0.4, 1.0]).part([0.2, 1.0]).last);
        assert!(!whole.part([0.4, 0.9]).part([0.2, 1.0]).last);
        assert!(!whole.part([0.4, 1.0]).part([0.2, 0.9]).last);
    }

    // A tenth of the step, a tenth of the rest, and then all of it.
    #[test]
    fn a_long_step_counts_while_it_is_done() {
        let log = Log::default();
        let stage = Part::of(&log).stage("full fits", 2);
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
