//! `servoscope validate`

use std::path::PathBuf;

use servoscope_core::diagnose::ValidateError;
use servoscope_core::observer::Silent;

use crate::report;
use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation, given, terminal};

/// Arguments of `validate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What `identify --json` or `diagnose --json` has printed.
    #[arg(value_name = "RESULT.json")]
    result: PathBuf,
    /// Files of the other measurement: harmonic tables or time records.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Prints the result as JSON, and nothing else.
    #[arg(long, help_heading = "Output")]
    json: bool,
    #[command(flatten)]
    given: given::Args,
}

/// Tries the models of a result on another measurement.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let answer = computation::stored_answer(&args.result)?;
    let measurement = computation::measurement(&args.files, &args.given)?;
    let validation = BuiltIn.validate(&answer, &measurement, &Silent).map_err(|error| {
        let names: Vec<String> = args.files.iter().map(|file| file.display().to_string()).collect();
        match error {
            ValidateError::Cancelled => Failure::other(error),
            error => Failure::Input(format!("{}: {error}", names.join(", "))),
        }
    })?;
    let text = match args.json {
        true => computation::json(&validation)?,
        false => report::validation(&validation),
    };
    terminal::print_raw(text.as_bytes())
}
