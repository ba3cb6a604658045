//! `servoscope diagnose`

use std::path::PathBuf;

use crate::report;
use crate::report::page::Answer;
use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation};

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    computation: computation::Args,
    /// A second record to measure the gain on; not available in this version yet.
    #[arg(long, value_name = "FILE")]
    validate: Option<PathBuf>,
}

/// Says where the base model departs from a measurement, and names what it lacks.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(file) = &args.validate {
        return Err(Failure::Input(format!(
            "--validate {}: a diagnosis with a second record is not available in this version \
             yet; leave it out",
            file.display()
        )));
    }
    computation::answer(
        &args.computation,
        "diagnose",
        |measurement, request, observer| BuiltIn.diagnose(measurement, request, observer),
        report::diagnosis,
        |answer| Answer::Diagnosis(answer),
    )
}
