//! Figures as SVG: one file a figure, one line in the list `FIGURES`.
//!
//! A figure is a pure function from answers to text. Its colours suit light and
//! dark, its text is text, it runs no script and needs no other file.
//!
//! The SVG is written here rather than by a plotting crate: those looked at
//! (plotters, charming, plotly) fix every colour as an attribute or need a
//! script, so that one file cannot follow the reader's colour scheme.

mod bands;
mod bode;
mod bode_both;
mod bode_errors;
mod canvas;
pub mod chart;
mod convergence;
#[cfg(test)]
mod fixtures;
mod friction;
mod history;
mod linearity;
mod panel;
mod plan;
mod residuals;
mod scale;
mod series;
mod spectrum;
#[cfg(test)]
mod tests;
mod text;
mod theme;

use servoscope_core::answers::{
    Answer, Comparison, ConvergenceRow, Discrepancy, Identification, Linearity, Plan, ValidBand,
};

use canvas::Canvas;

pub use history::{Estimated, Trend};
pub use theme::{Format, Theme};

pub(super) use text::superscript;
pub(super) use theme::{DARK, LIGHT, Palette};

/// What figures are drawn of. What is not known is left out, and with it the
/// figures that need it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Subject<'a> {
    /// The identified model.
    pub identification: Option<&'a Identification>,
    /// The measurement beside what that model makes of it.
    pub comparison: Option<&'a Comparison>,
    /// What the data tell before any model.
    pub linearity: Option<&'a Linearity>,
    /// Where the two depart.
    pub discrepancy: Option<&'a Discrepancy>,
    /// Where the best model may be used.
    pub valid_band: Option<&'a ValidBand>,
    /// The model with the causes of that.
    pub extended: Option<Extended<'a>>,
    /// How the identification converged.
    pub convergence: &'a [ConvergenceRow],
    /// What the model with the causes is called, where this is of that one.
    pub named: Option<&'a str>,
}

impl<'a> Subject<'a> {
    /// A title of a figure of one model: with its name, where there are two.
    fn titled(&self, title: &str) -> String {
        match (self.named, self.extended) {
            (Some(name), _) => format!("{title}: {name}"),
            (None, Some(_)) => format!("{title}: base model"),
            (None, None) => title.to_owned(),
        }
    }

    /// What an answer alone shows: no measurement beside it, no history.
    pub fn of(answer: &'a Answer) -> Self {
        let identification = Some(answer.base());
        let diagnosis = answer.diagnosis();
        let linearity = diagnosis.and_then(|answer| answer.linearity.as_ref());
        let valid_band = diagnosis.and_then(|answer| answer.valid_band.as_ref());
        let discrepancy = answer.discrepancy();
        Self { identification, linearity, discrepancy, valid_band, ..Self::default() }
    }

    /// The model with the causes in the place of the identified one.
    ///
    /// # Errors
    /// [`NothingToDraw`] where there is none.
    pub fn after(&self) -> Result<Self, NothingToDraw> {
        let Extended { name, identification, comparison } = self.extended.ok_or_else(|| {
            NothingToDraw("it shows a model with causes, and there is none".into())
        })?;
        let (identification, comparison) = (Some(identification), Some(comparison));
        Ok(Self { identification, comparison, named: Some(name), ..Self::default() })
    }
}

/// A model that has what the identified one lacks.
#[derive(Debug, Clone, Copy)]
pub struct Extended<'a> {
    /// What it is called: `with stribeck`.
    pub name: &'a str,
    /// The model itself.
    pub identification: &'a Identification,
    /// The measurement beside what it makes of it.
    pub comparison: &'a Comparison,
}

/// There is nothing to draw; says what is missing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NothingToDraw(pub String);

type Draw = fn(&Subject<'_>) -> Result<Canvas, NothingToDraw>;

/// Every figure: its name and how it is drawn; those `-after` are of the model with the causes.
const FIGURES: &[(&str, Draw)] = &[
    ("bode", bode::draw),
    ("bode-errors", bode_errors::draw),
    ("linearity", linearity::draw),
    ("spectrum", spectrum::draw),
    ("residuals", residuals::draw),
    ("convergence", convergence::draw),
    ("friction", friction::draw),
    ("spectrum-after", |subject| spectrum::draw(&subject.after()?)),
    ("residuals-after", |subject| residuals::draw(&subject.after()?)),
    ("friction-after", |subject| friction::draw(&subject.after()?)),
];

/// Names of all figures, in the order they are shown to a reader.
pub fn names() -> impl Iterator<Item = &'static str> {
    FIGURES.iter().map(|(name, _)| *name)
}

/// Names of the figures that can be drawn of a subject.
pub fn available(subject: &Subject<'_>) -> Vec<&'static str> {
    let drawn = FIGURES.iter().filter(|(_, draw)| draw(subject).is_ok());
    drawn.map(|(name, _)| *name).collect()
}

/// Draws the figure of this name as an SVG document.
///
/// # Errors
/// [`NothingToDraw`] where there is no figure of this name or the subject lacks
/// what it shows.
pub fn draw(
    name: &str,
    subject: &Subject<'_>,
    format: impl Into<Format>,
) -> Result<String, NothingToDraw> {
    draw_beside(name, subject, format.into(), "")
}

/// Draws the frequency responses of two subjects, left and right, in one diagram.
///
/// # Errors
/// [`NothingToDraw`] where one of them is not compared with a model, or their gains have different
/// units.
pub fn draw_both(
    both: [&Subject<'_>; 2],
    format: impl Into<Format>,
) -> Result<String, NothingToDraw> {
    Ok(bode_both::draw(both)?.finish(format.into(), ""))
}

/// Draws parameters of an axis over the time of measuring.
///
/// # Errors
/// [`NothingToDraw`] where there are none.
pub fn draw_history(
    title: &str,
    trends: &[Trend],
    format: impl Into<Format>,
) -> Result<String, NothingToDraw> {
    Ok(history::draw(title, trends)?.finish(format.into(), ""))
}

/// Draws the experiments of a plan, and what they identify beside a sweep of the same duration;
/// `input_unit` is empty where it is not known.
pub fn draw_plan(subject: &Plan, input_unit: &str, format: impl Into<Format>) -> String {
    plan::draw(subject, input_unit).finish(format.into(), "")
}

/// The same for a page that shows figures of one name of several subjects:
/// `suffix` tells the ids in this one from those in the others.
///
/// # Errors
/// As for [`draw`].
pub(super) fn draw_beside(
    name: &str,
    subject: &Subject<'_>,
    format: Format,
    suffix: &str,
) -> Result<String, NothingToDraw> {
    let figure = FIGURES.iter().find(|(known, _)| *known == name);
    let (_, draw) = figure.ok_or_else(|| NothingToDraw("no figure has this name".into()))?;
    Ok(draw(subject)?.finish(format, suffix))
}

/// The response before and after and its errors, for a phone; its id ends in `-phone`.
///
/// # Errors
/// As for [`draw`].
pub(super) fn draw_for_phone(
    subject: &Subject<'_>,
    format: Format,
) -> Result<String, NothingToDraw> {
    Ok(bode_errors::draw_for_phone(subject)?.finish(format, "-phone"))
}

/// The comparison of a subject, which several figures need.
fn comparison<'a>(subject: &Subject<'a>) -> Result<&'a Comparison, NothingToDraw> {
    let comparison = subject.comparison.filter(|comparison| !comparison.experiments.is_empty());
    comparison.ok_or_else(|| {
        NothingToDraw("it compares measured with simulated responses, and there are none".into())
    })
}
