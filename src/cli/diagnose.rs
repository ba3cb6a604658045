//! `servoscope diagnose`

use std::path::PathBuf;

use super::{Failure, computation};

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// A second measurement of the same axis, on which the improvement is measured; repeat it for a
    /// measurement of several files [default: parts of the first that a fit leaves out].
    #[arg(long, value_name = "FILE")]
    validate: Vec<PathBuf>,
    /// Takes the measurement as it is: leaves no row out, and looks for no fault of the
    /// measurement.
    #[arg(long)]
    keep_all: bool,
    #[command(flatten)]
    computation: computation::Args,
}

/// Says where the simulation differs from a measurement, and names the cause.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let second = match args.validate.as_slice() {
        [] => None,
        files => Some(computation::measurement(files, &args.computation.given)?),
    };
    computation::answer(&args.computation, "diagnose", second.as_ref(), args.keep_all)
}
