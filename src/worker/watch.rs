//! What a job's task and its computation tell each other.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use servoscope_core::answers::{ConvergenceRow, Progress};
use servoscope_core::observer::Observer;

use crate::store::ConvergencePoint;

/// Collects what a computation reports and tells it when to stop.
#[derive(Debug)]
pub(super) struct Watch {
    began: Instant,
    cancelled: AtomicBool,
    reported: Mutex<Reported>,
}

#[derive(Debug, Default)]
struct Reported {
    progress: Option<Progress>,
    rows: Vec<ConvergencePoint>,
    next_seq: i64,
}

impl Watch {
    /// For an attempt whose first row has the position `next_seq`.
    pub(super) fn new(next_seq: i64) -> Self {
        Self {
            began: Instant::now(),
            cancelled: AtomicBool::new(false),
            reported: Mutex::new(Reported { next_seq, ..Reported::default() }),
        }
    }

    /// Time since the attempt began.
    pub(super) fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    /// The computation is no longer wanted.
    pub(super) fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// What was reported since the last call: the latest progress, all rows.
    pub(super) fn take(&self) -> (Option<Progress>, Vec<ConvergencePoint>) {
        let mut reported = self.reported();
        (reported.progress.take(), std::mem::take(&mut reported.rows))
    }

    fn reported(&self) -> MutexGuard<'_, Reported> {
        // A panic cannot leave it half-written: every change is one assignment.
        self.reported.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Watch {
    fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn progress(&self, progress: Progress) {
        self.reported().progress = Some(progress);
    }

    fn row(&self, row: ConvergenceRow) {
        // Before a first usable candidate there is no best cost; neither JSON nor
        // a plot has a place for infinity.
        if !row.best.is_finite() {
            return;
        }
        let mut reported = self.reported();
        let seq = reported.next_seq;
        reported.next_seq += 1;
        reported.rows.push(ConvergencePoint {
            seq,
            stage: row.stage,
            cycle: row.cycle.cast_signed(),
            evaluations: row.evaluations.cast_signed(),
            best: row.best,
            mean: row.mean.filter(|mean| mean.is_finite()),
            elapsed_s: row.elapsed_s,
        });
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(best: f64) -> ConvergenceRow {
        let stage = "colony".to_owned();
        ConvergenceRow { stage, cycle: 1, evaluations: 2, best, mean: Some(best), elapsed_s: 0.5 }
    }

    #[test]
    fn rows_are_taken_once_and_numbered_through() {
        let watch = Watch::new(7);
        watch.row(row(3.0));
        watch.row(row(2.0));
        let (_, first) = watch.take();
        watch.row(row(1.0));
        let (_, second) = watch.take();
        assert_eq!(first.iter().map(|row| row.seq).collect::<Vec<_>>(), [7, 8]);
        assert_eq!(second.iter().map(|row| row.seq).collect::<Vec<_>>(), [9]);
    }

    #[test]
    fn a_row_without_a_finite_cost_is_left_out() {
        let watch = Watch::new(0);
        watch.row(row(f64::INFINITY));
        watch.row(row(f64::NAN));
        watch.row(ConvergenceRow { mean: Some(f64::INFINITY), ..row(1.0) });
        let (_, rows) = watch.take();
        assert_eq!(rows.len(), 1);
        assert_eq!((rows[0].seq, rows[0].mean), (0, None));
    }
}
