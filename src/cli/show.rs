//! `servoscope show`

use std::path::PathBuf;

use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation, given, shown};

/// Arguments of `show`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What `identify --json` or `diagnose --json` has printed, or the result of a job.
    #[arg(value_name = "RESULT.json")]
    result: PathBuf,
    /// Files that it was computed from; only figures and the page need them.
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    given: given::Args,
    #[command(flatten)]
    shown: shown::Args,
}

/// Shows a stored result; nothing is fitted.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let answer = computation::stored_answer(&args.result)?;
    if args.files.is_empty() {
        return match args.shown.needs_measurement() {
            true => Err(Failure::Input(
                "figures and the page need the files that the result was computed from".into(),
            )),
            false => args.shown.print(&answer),
        };
    }
    args.shown.check()?;
    let files = computation::read(&args.files, &args.given)?;
    let sources = computation::sources(&files);
    let measurement = BuiltIn.read(&sources).map_err(Failure::input)?;
    args.shown.print(&answer)?;
    // How the computation converged is not part of a result.
    args.shown.write(&answer, &measurement, &sources, &[])
}
