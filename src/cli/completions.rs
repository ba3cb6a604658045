//! `servoscope completions`

use clap::CommandFactory as _;
use clap_complete::{Shell, generate};

use super::{Cli, Failure, terminal};

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The shell that the script is for.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints the script.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), env!("CARGO_PKG_NAME"), &mut script);
    terminal::print_raw(&script)
}
