//! `servoscope config`, and where `serve` gets its settings from.

use std::path::PathBuf;

use clap::ArgMatches;
use clap::parser::ValueSource;

use crate::config::{ServeConfig, Settings};

use super::{Failure, terminal};

/// Arguments of every command that needs the settings of a server.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// File of settings, TOML: the names of the flags below with underscores [default: none].
    #[arg(long = "config", value_name = "FILE", env = "SERVOSCOPE_CONFIG")]
    file: Option<PathBuf>,
    #[command(flatten)]
    told: Settings,
}

/// Subcommands of `config`.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Command {
    /// Prints every setting in effect, as a file that says the same, and where each
    /// comes from.
    Show(Args),
}

impl Args {
    /// The settings in effect, unchecked.
    ///
    /// # Errors
    /// [`Failure::Input`] where the file cannot be read.
    pub(super) fn settings(&self) -> Result<Settings, Failure> {
        Ok(self.told.clone().over(self.file()?).completed())
    }

    fn file(&self) -> Result<Settings, Failure> {
        let file = self.file.as_deref().map(Settings::read).transpose().map_err(Failure::input)?;
        Ok(file.unwrap_or_default())
    }
}

/// Prints the settings. `matches` are those of `show`.
pub(super) fn run(command: &Command, matches: &ArgMatches) -> Result<(), Failure> {
    let Command::Show(args) = command;
    let in_file = args.file()?.entries();
    let settings = args.settings()?;
    let mut text = String::new();
    for ((name, value), (_, filed)) in settings.entries().into_iter().zip(in_file) {
        let origin = match matches.value_source(name) {
            Some(ValueSource::CommandLine) => "flag",
            Some(ValueSource::EnvVariable) => "environment",
            _ if filed.is_some() => "file",
            _ => "default",
        };
        text.push_str(&match value {
            Some(value) => format!("{:<40} # {origin}\n", format!("{name} = {value}")),
            None => format!("{:<40} # not set\n", format!("# {name} =")),
        });
    }
    terminal::print_raw(text.as_bytes())?;
    // Shown first: what is refused can be seen.
    ServeConfig::check(settings).map(|_| ()).map_err(Failure::input)
}
