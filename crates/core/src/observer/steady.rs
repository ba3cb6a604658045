//! Progress of a whole computation: a fraction that never decreases, and the time left.

use std::sync::{Mutex, PoisonError};

use crate::answers::{ConvergenceRow, Progress};

use super::Observer;
use super::remaining_time::RemainingTime;

/// Passes the progress of a whole computation on to its observer.
///
/// The fraction never decreases: a search does not know beforehand how often it repeats a stage,
/// and a stage that is repeated begins at its old share again. The estimate of the time left is
/// added here, once for every observer.
pub(crate) struct Steady<'a> {
    whole: &'a dyn Observer,
    reached: Mutex<Reached>,
}

#[derive(Default)]
struct Reached {
    fraction: f64,
    /// Nothing is estimated until the rest is certain.
    remaining: RemainingTime,
}

impl<'a> Steady<'a> {
    /// At the beginning of a computation.
    pub fn new(whole: &'a dyn Observer) -> Self {
        Self { whole, reached: Mutex::default() }
    }
}

impl Observer for Steady<'_> {
    fn elapsed_s(&self) -> f64 {
        self.whole.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        // The lock is held while reporting, so that fractions arrive in order.
        let mut reached = self.reached.lock().unwrap_or_else(PoisonError::into_inner);
        reached.fraction = reached.fraction.max(progress.fraction);
        let fraction = reached.fraction;
        let remaining_s = reached.remaining.after(self.whole.elapsed_s(), fraction);
        self.whole.progress(Progress { fraction, remaining_s, ..progress });
    }

    fn rest_is_certain(&self) {
        let mut reached = self.reached.lock().unwrap_or_else(PoisonError::into_inner);
        reached.remaining = RemainingTime::since(self.whole.elapsed_s(), reached.fraction);
        self.whole.rest_is_certain();
    }

    fn row(&self, row: ConvergenceRow) {
        self.whole.row(row);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps what is reported; each report takes a second.
    #[derive(Default)]
    struct Log(Mutex<Vec<(f64, Option<f64>)>>);

    impl Observer for Log {
        fn elapsed_s(&self) -> f64 {
            self.0.lock().unwrap().len() as f64
        }

        fn progress(&self, progress: Progress) {
            self.0.lock().unwrap().push((progress.fraction, progress.remaining_s));
        }
    }

    /// What is reported if the rest is certain from this step on.
    fn reported(
        fractions: impl Iterator<Item = f64>,
        certain_from: Option<usize>,
    ) -> Vec<(f64, Option<f64>)> {
        let log = Log::default();
        let steady = Steady::new(&log);
        for (step, fraction) in fractions.enumerate() {
            if certain_from == Some(step) {
                steady.rest_is_certain();
            }
            let stage = "search".to_owned();
            steady.progress(Progress { stage, done: 0, total: 1, fraction, remaining_s: None });
        }
        log.0.into_inner().unwrap()
    }

    #[test]
    fn the_fraction_stays_where_a_stage_is_repeated() {
        let fractions: Vec<f64> =
            reported([0.2, 0.6, 0.2, 0.6].into_iter(), None).iter().map(|seen| seen.0).collect();
        assert_eq!(fractions, [0.2, 0.6, 0.6, 0.6]);
    }

    // One percent a second: 20 seconds are left at 80 %. The rest is certain a step late.
    #[test]
    fn the_time_left_is_reported_with_the_fraction_once_the_rest_is_certain() {
        let fractions = || (0..=100).map(|percent| 0.01 * f64::from(percent));
        assert!(reported(fractions(), None).iter().all(|seen| seen.1.is_none()));
        let seen = reported(fractions(), Some(40));
        assert!(seen[..=40].iter().all(|seen| seen.1.is_none()));
        let left = seen[80].1.expect("steady progress");
        assert!((left - 20.0).abs() < 1.0, "{left}");
    }
}
