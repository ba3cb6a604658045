//! Tests of every accepted form of upload, and of the error for every refused one.

use super::*;
use crate::measurement::Complex;
use crate::measurement::ResponseKind;

mod accepted;
mod arbitrary;
mod dialects;
mod json;
mod look;
mod mutated;
mod mutation;
mod names;
mod noise;
mod periods;
mod records;
mod refused;
mod universal;
mod workbooks;
mod written;

fn of(text: &str) -> Result<Measurement, ParseError> {
    read(&[Source { name: "test.csv", bytes: text.as_bytes() }])
}

fn ok(text: &str) -> Measurement {
    of(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Line, column and reason of the error for a faulty text.
fn fault(text: &str) -> (Option<u64>, Option<String>, String) {
    let error = of(text).map(|_| ()).expect_err(text);
    (error.line, error.column, error.reason)
}

/// Asserts the line and column of the error for a faulty text, and that its reason contains `word`.
#[track_caller]
fn refused(text: &str, line: impl Into<Option<u64>>, column: &str, word: &str) {
    let (found_line, found_column, reason) = fault(text);
    let column = (!column.is_empty()).then_some(column);
    assert_eq!((found_line, found_column.as_deref()), (line.into(), column), "{reason}\n{text}");
    assert!(reason.contains(word), "`{reason}` does not say `{word}`");
}

/// Yₖ of an experiment.
fn y(measurement: &Measurement, experiment: usize, k: usize) -> Complex {
    measurement.experiments()[experiment].harmonic(k).expect("measured").value
}

/// A time record of `periods` periods with `samples` samples each, 1 ms apart.
fn record(samples: usize, periods: usize) -> String {
    let mut text = String::from("time_s,input,output\n");
    for n in 0..samples * periods {
        let angle = std::f64::consts::TAU * n as f64 / samples as f64;
        let scatter = ((n * 7919) % 101) as f64 * 1e-5;
        let (u, v) = (2.0 * angle.cos(), (angle - 0.5).cos() + 0.1 * (3.0 * angle).sin());
        text += &format!("{:.3},{u:.6},{:.6}\n", n as f64 * 1e-3, v + scatter);
    }
    text
}
