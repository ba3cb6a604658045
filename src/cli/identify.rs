//! `servoscope identify`

use crate::report;
use crate::report::page::Answer;
use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation};

/// Fits the base model to a measurement and prints the answer.
pub(super) fn run(args: &computation::Args) -> Result<(), Failure> {
    computation::answer(
        args,
        "identify",
        |measurement, request, observer| BuiltIn.identify(measurement, request, observer),
        report::identification,
        |answer| Answer::Identification(answer),
    )
}
