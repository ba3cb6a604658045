//! An answer as one HTML page to hand to somebody else.
//!
//! The page needs nothing but itself: no request, its figures are inline SVG, and
//! its style sheet is inside. What a test engineer takes away is on the first screen;
//! the rest is folded below it in the order in which a reader asks. It is read on a
//! screen, light or dark, on a phone, and on paper. It is well-formed XML, too. One
//! file a section, one line in the list `SECTIONS`.

mod cards;
mod described;
mod discrepancy;
mod figure;
mod friction;
mod harmonics;
mod head;
mod measured;
mod model;
mod provenance;
mod rivals;
mod style;
mod sure;
mod table;
#[cfg(test)]
mod tests;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use servoscope_core::answers::{Answer, Comparison, ConvergenceRow};

use super::brief::Units;
use super::figures::{Extended, Subject};
use super::script;
use super::words;

pub use super::words::{parameter_name, parameter_names};
pub(super) use measured::read;
pub use measured::{DataFile, Measured};
pub use style::{dark as dark_colours, shared as shared_style};

/// What a page is made of. What is not known is left out, and with it the
/// figures that need it.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The answer.
    pub answer: &'a Answer,
    /// What was measured.
    pub measured: &'a Measured,
    /// The measurement beside what the base model makes of it.
    pub comparison: Option<&'a Comparison>,
    /// The measurement beside what the model with the causes makes of it.
    pub extended: Option<&'a Comparison>,
    /// How the computation converged.
    pub convergence: &'a [ConvergenceRow],
}

impl<'a> Content<'a> {
    /// Units of the input and of the response, where they are known.
    fn units(&self) -> Units<'a> {
        let of = self.comparison;
        Units {
            input: of.map_or(&self.measured.input_unit, |of| &of.input_unit),
            response: of.map_or(&self.measured.response_unit, |of| &of.response_unit),
        }
    }

    /// What the figures are drawn of; `name` is that of the model with the causes.
    fn subject(&self, name: &'a str) -> Subject<'a> {
        let extended = self.answer.extended().zip(self.extended);
        let extended = extended.map(|(identification, comparison)| Extended {
            name,
            identification,
            comparison,
        });
        Subject {
            comparison: self.comparison,
            extended,
            convergence: self.convergence,
            ..Subject::of(self.answer)
        }
    }
}

/// A section that is folded until somebody asks: what is linked to, what it is called, its answer
/// in short, and the whole; `None` where an answer has nothing of the kind.
struct Section {
    id: &'static str,
    title: &'static str,
    short: String,
    body: Markup,
}

impl Section {
    fn new(id: &'static str, title: &'static str, short: String, body: Markup) -> Option<Self> {
        Some(Self { id, title, short, body })
    }
}

/// Every section, in the order in which a reader asks.
const SECTIONS: &[fn(&Content<'_>) -> Option<Section>] = &[
    sure::section,
    rivals::section,
    discrepancy::section,
    friction::section,
    harmonics::section,
    model::computed,
    model::section,
    provenance::section,
];

/// Writes the page.
pub fn page(content: &Content<'_>) -> String {
    let sections: Vec<Section> = SECTIONS.iter().filter_map(|write| write(content)).collect();
    let title = head::title(content);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                // Not as elements: those would end without the slash that XML wants.
                (PreEscaped("<meta charset=\"utf-8\"/>\
                    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"))
                title { (title) }
                style { (PreEscaped(style::sheet())) }
            }
            body {
                (head::header(content, &title))
                main {
                    div.screen {
                        (figure::first(content))
                        (cards::cards(content))
                    }
                    @for section in &sections {
                        details id=(section.id) {
                            summary { h2 { (section.title) } span.short { (section.short) } }
                            div.whole { (section.body) }
                        }
                    }
                }
                script type="module" { (PreEscaped(script::inline())) }
            }
        }
    };
    printable(page.into_string())
}

/// Replaces what neither HTML nor XML allows in a text.
fn printable(text: String) -> String {
    let forbidden = |c: char| matches!(c, '\u{fffe}' | '\u{ffff}') || c.is_control() && c != '\n';
    if text.contains(forbidden) { text.replace(forbidden, "\u{fffd}") } else { text }
}
