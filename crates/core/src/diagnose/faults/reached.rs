//! The progress of a diagnosis in rounds.

use std::sync::{Mutex, PoisonError};

use crate::answers::{ConvergenceRow, Progress};
use crate::diagnose::progress::Part;
use crate::observer::Observer;

/// Keeps the fraction of the progress that was reached, so that another round goes on from there.
pub(super) struct Reached<'a> {
    whole: &'a Part<'a>,
    fraction: Mutex<f64>,
}

impl<'a> Reached<'a> {
    /// Of this part, of which nothing is done.
    pub fn of(whole: &'a Part<'a>) -> Self {
        Self { whole, fraction: Mutex::new(0.0) }
    }

    /// What is left of the whole.
    pub fn rest(&self) -> Part<'_> {
        let fraction = *self.fraction.lock().unwrap_or_else(PoisonError::into_inner);
        Part { whole: self, span: [fraction, 1.0], last: self.whole.last }
    }
}

impl Observer for Reached<'_> {
    fn elapsed_s(&self) -> f64 {
        self.whole.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        *self.fraction.lock().unwrap_or_else(PoisonError::into_inner) = progress.fraction;
        self.whole.progress(progress);
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
