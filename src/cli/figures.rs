//! Figures of an answer, written as files.

use std::path::PathBuf;

use crate::report::figures::{self, Subject, Theme};

use super::choice::one_of;
use super::{Failure, target};

/// Arguments of every command that can draw its answer.
#[derive(Debug, Default, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Draws the answer into this folder: bode.svg, spectrum.svg, residuals.svg …
    #[arg(long = "figures", value_name = "DIR", help_heading = "Output")]
    directory: Option<PathBuf>,
    /// Colours of the figures; auto: those that the reader of the page prefers.
    #[arg(long, value_name = "NAME", default_value = "auto", requires = "directory")]
    #[arg(help_heading = "Output")]
    #[arg(value_parser = one_of::<Theme>(Theme::ALL.iter().map(|theme| theme.name())))]
    theme: Theme,
}

impl Args {
    /// Whether any figure was asked for.
    pub(super) fn are_wanted(&self) -> bool {
        self.directory.is_some()
    }

    /// Looks whether the folder takes files.
    ///
    /// # Errors
    /// [`Failure::Input`] where it does not.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.directory.as_deref().map_or(Ok(()), target::folder)
    }

    /// Writes every figure that can be drawn of a subject, and says on standard
    /// error which, and why not the others.
    ///
    /// # Errors
    /// [`Failure::Input`] where the folder or a file cannot be written.
    pub(super) fn write(&self, subject: &Subject<'_>) -> Result<(), Failure> {
        let Some(directory) = &self.directory else { return Ok(()) };
        let failure =
            |path: &PathBuf, error| Failure::Input(format!("{}: {error}", path.display()));
        std::fs::create_dir_all(directory).map_err(|error| failure(directory, error))?;
        for name in figures::names() {
            match figures::draw(name, subject, self.theme) {
                Ok(svg) => {
                    let path = directory.join(format!("{name}.svg"));
                    std::fs::write(&path, svg).map_err(|error| failure(&path, error))?;
                    eprintln!("figure: {}", path.display());
                }
                Err(reason) => eprintln!("no figure `{name}`: {reason}"),
            }
        }
        Ok(())
    }
}
