//! `servoscope man`

use std::path::PathBuf;

use clap::CommandFactory as _;
use clap_mangen::{Man, generate_to};

use super::{Cli, Failure, target, terminal};

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Writes servoscope.1, servoscope-diagnose.1 … into this folder; it is made if it is not
    /// there [default: prints servoscope.1 alone].
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Prints the page of the program, or writes those of all its commands.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let Some(folder) = &args.output else {
        let mut page = Vec::new();
        Man::new(Cli::command()).render(&mut page).map_err(Failure::other)?;
        return terminal::print_raw(&page);
    };
    target::folder(folder)?;
    generate_to(Cli::command(), folder).map_err(|error| Failure::unwritten(folder, &error))
}
