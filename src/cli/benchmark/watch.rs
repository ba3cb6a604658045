//! How far the draws have come, and whether to stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressStyle};
use servoscope_bench::naming::{Case, Outcome, Unmade};
use servoscope_core::observer::Observer;

use crate::cli::interrupt;

/// Shows progress and stops on an interrupt.
pub(super) struct Watch {
    interrupted: Arc<AtomicBool>,
    pub(super) bar: ProgressBar,
    total: usize,
    done: AtomicUsize,
    missed: AtomicUsize,
}

impl Watch {
    pub(super) fn new(total: usize) -> Self {
        let style = ProgressStyle::with_template("[{bar:40}] {pos}/{len} {elapsed} of {eta} {msg}");
        let bar = ProgressBar::new(total as u64);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let (done, missed) = Default::default();
        Self { interrupted: interrupt::flag(), bar, total, done, missed }
    }

    pub(super) fn done(&self, case: &Case, result: &Result<Outcome, Unmade>) {
        let right = result.as_ref().is_ok_and(Outcome::is_right);
        let missed = self.missed.fetch_add(usize::from(!right), Ordering::Relaxed);
        let missed = missed + usize::from(!right);
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.inc(1);
        self.bar.set_message(format!("{missed} missed; {case}"));
        // The bar draws on terminals only.
        let stride = (self.total / 50).max(1);
        if self.bar.is_hidden() && (done.is_multiple_of(stride) || done == self.total) {
            eprintln!("{done} of {} draws, {missed} missed; {case}", self.total);
        }
    }
}

impl Observer for Watch {
    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
