//! Where the simulation departs from the measurement.

use maud::{Markup, html};
use servoscope_core::answers::{Discrepancy, NoiseSource, Pattern, Verdict};

use crate::report::tables;

use super::described::described;
use super::figure::figure;
use super::table::{Cell, table};
use super::words::sentence;
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let Some(answer) = content.answer.diagnosis() else { return fit(content) };
    let found = &answer.discrepancy;
    let subject = content.subject("");
    let title = match answer.verdict {
        Verdict::Adequate => "How small a departure would have been noticed",
        _ => "What the simulation gets wrong",
    };
    let body = html! {
        p.lead { (sentence(&found.sentence)) }
        (patterns(&found.patterns))
        (figure("residuals", &subject, "", "What the base model leaves of every harmonic, against its noise."))
        (figure("spectrum", &subject, "", "Harmonics of the response, measured and simulated with \
            the base model, above the noise."))
        h3 { "Is it noise?" }
        p { "Each test holds what the model leaves against noise; " i { "p" } " is how often noise \
            alone looks as bad." }
        @if !found.tests.is_empty() { (described("", &tables::tests(&found.tests), &[])) }
        h3 { "What is left, part by part" }
        (left(found, answer.base.noise))
    };
    Section::new("departure", title, body)
}

/// Of an identification, nobody asked where it is wrong; the figures show it.
fn fit(content: &Content<'_>) -> Option<Section> {
    let subject = content.subject("");
    let body = html! {
        (figure("residuals", &subject, "", "What the model leaves of every harmonic, against its noise."))
        (figure("spectrum", &subject, "", "Harmonics of the response, measured and simulated, \
            above the noise."))
    };
    if body.0.is_empty() {
        return None;
    }
    Section::new("departure", "What the model leaves", body)
}

fn patterns(patterns: &[Pattern]) -> Markup {
    let row = |(i, pattern): (usize, &Pattern)| {
        vec![
            Cell::number((i + 1).to_string()),
            Cell::Sentence(sentence(&pattern.sentence)),
            Cell::number(format!("{:.0}", 100.0 * pattern.share)),
        ]
    };
    let rows: Vec<Vec<Cell>> = patterns.iter().enumerate().map(row).collect();
    let titles = ["", "Where and how", "share, %"];
    html! { @if !rows.is_empty() { (table("Patterns, largest share of the misfit first", &titles, &rows)) } }
}

/// Residuals by what the measurement has several of.
fn left(found: &Discrepancy, noise: NoiseSource) -> Markup {
    html! {
        p {
            @match noise {
                NoiseSource::Estimated => {
                    "Root mean squares of what the base model leaves: over that of everything it \
                     leaves, in units of the response, and as a share of what was measured."
                }
                _ => {
                    "Root mean squares of what the base model leaves: over the noise (1 is noise), \
                     in units of the response, and as a share of what was measured."
                }
            }
        }
        div.columns {
            @for (_, by) in tables::residuals(found, noise) {
                @if !by.rows.is_empty() { (described("", &by, &[])) }
            }
        }
    }
}
