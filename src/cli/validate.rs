//! `servoscope validate`

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::answers::Answer;
use crate::diagnose::ValidateError;
use crate::observer::Silent;
use crate::report;
use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation};

/// Arguments of `validate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What `identify --json` or `diagnose --json` has printed.
    #[arg(value_name = "RESULT.json")]
    result: PathBuf,
    /// Harmonic tables or time records that together are another measurement.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Prints the result object alone.
    #[arg(long)]
    json: bool,
}

/// Tries the models of a result on another measurement.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let answer = answer(&args.result)?;
    let measurement = computation::measurement(&args.files)?;
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
    std::io::stdout().write_all(text.as_bytes()).map_err(Failure::other)
}

fn answer(path: &Path) -> Result<Answer, Failure> {
    let wrong = |reason: &dyn std::fmt::Display| {
        Failure::Input(format!(
            "{}: not a result that `identify --json` or `diagnose --json` prints: {reason}",
            path.display()
        ))
    };
    let bytes = std::fs::read(path)
        .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
    let text = String::from_utf8(bytes).map_err(|error| wrong(&error))?;
    Answer::from_json(&text).map_err(|error| wrong(&error))
}
