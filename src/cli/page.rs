//! The page of an answer, written as a file.

use std::path::PathBuf;

use crate::report::page::{Content, page};

use super::{Failure, target};

/// Argument of every command whose answer can be a page.
#[derive(Debug, Default, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Writes the answer as one HTML page, with its figures, into this file.
    #[arg(long = "report", value_name = "FILE", help_heading = "Output")]
    file: Option<PathBuf>,
}

impl Args {
    /// Whether a page was asked for.
    pub(super) fn is_wanted(&self) -> bool {
        self.file.is_some()
    }

    /// Looks whether the file can be written.
    ///
    /// # Errors
    /// [`Failure::Input`] where it cannot.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.file.as_deref().map_or(Ok(()), target::file)
    }

    /// Writes the page, and says on standard error where.
    ///
    /// # Errors
    /// [`Failure::Input`] where the file cannot be written.
    pub(super) fn write(&self, content: &Content<'_>) -> Result<(), Failure> {
        let Some(file) = &self.file else { return Ok(()) };
        let failure = |error| Failure::Input(format!("{}: {error}", file.display()));
        std::fs::write(file, page(content)).map_err(failure)?;
        eprintln!("report: {}", file.display());
        Ok(())
    }
}
