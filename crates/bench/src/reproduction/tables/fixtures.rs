//! A run for the tests.

use servoscope_core::answers::Method;
use servoscope_core::measurement::Complex;

use crate::reproduction::figure_of_merit::largest_error;
use crate::reproduction::runs::{Outcome, Run};
use crate::reproduction::system::{System, reported};

/// A run of a colony that found these rows.
pub(super) fn run(system: System, rows: Vec<Complex>) -> Run {
    let outcome = Outcome {
        error: largest_error(system, &rows),
        rows,
        values: reported(&system.plant()),
        evaluations: 1000,
        seconds: 0.5,
        success: true,
    };
    Run {
        system,
        level: None,
        method: Method::AbcAnn,
        seed: 1,
        alone: Some(outcome.clone()),
        refined: Some(outcome),
        budget: Some(1010),
        stop_reason: "every cycle ended".into(),
        history: Vec::new(),
    }
}
