//! How an answer is shown: on the terminal, as figures, as a page.

use servoscope_core::answers::{Answer, ConvergenceRow};
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::Source;

use crate::report;
use crate::report::page::Content;
use crate::service::{BuiltIn, Compared, measured};

use super::{Failure, figures, page, terminal};

/// Arguments of every command that shows an answer.
#[derive(Debug, Default, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Prints the whole answer, some 200 lines, instead of its main points in at most 40.
    #[arg(long, help_heading = "Output")]
    full: bool,
    #[command(flatten)]
    figures: figures::Args,
    #[command(flatten)]
    page: page::Args,
}

impl Args {
    /// Whether anything is wanted for which the measurement is simulated.
    pub(super) fn needs_measurement(&self) -> bool {
        self.figures.are_wanted() || self.page.is_wanted()
    }

    /// Looks, before anything is computed, whether all can be written.
    ///
    /// # Errors
    /// [`Failure::Input`] names what cannot.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.figures.check()?;
        self.page.check()
    }

    /// Prints an answer.
    ///
    /// # Errors
    /// [`Failure::Other`] where it cannot be printed.
    pub(super) fn print(&self, answer: &Answer) -> Result<(), Failure> {
        let width = terminal::width();
        let text = match self.full {
            true => report::answer(answer, width),
            false => report::summary(answer, width),
        };
        terminal::print(&text)
    }

    /// Writes the figures and the page of an answer, where they are asked for.
    ///
    /// # Errors
    /// [`Failure::Input`] where a file cannot be written.
    pub(super) fn write(
        &self,
        answer: &Answer,
        measurement: &Measurement,
        sources: &[Source<'_>],
        convergence: &[ConvergenceRow],
    ) -> Result<(), Failure> {
        if !self.needs_measurement() {
            return Ok(());
        }
        let compared = Compared::of(&BuiltIn, Ok(measurement), answer);
        self.figures.write(&compared.subject(answer, convergence))?;
        self.page.write(&Content {
            answer,
            measured: &measured(Some(measurement), sources),
            comparison: compared.base.as_ref().ok(),
            extended: compared.extended.as_ref(),
            convergence,
        })
    }
}
