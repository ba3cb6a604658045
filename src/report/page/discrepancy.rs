//! Where the simulation departs from the measurement.

use maud::{Markup, html};
use servoscope_core::answers::{
    Discrepancy, NoiseSource, Pattern, ResidualGroup, ResidualTest, Verdict,
};

use crate::report::number::{digits, significant};

use super::figure::figure;
use super::table::{Cell, table};
use super::words::sentence;
use super::{Content, Section};

/// Probability below which another power of ten says nothing.
const LEAST_P: f64 = 1e-6;

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
        (tests(&found.tests))
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

fn tests(tests: &[ResidualTest]) -> Markup {
    let row = |test: &ResidualTest| {
        let p_value = match test.p_value {
            None => Cell::empty(),
            Some(p) if p < LEAST_P => Cell::Number("< 10⁻⁶".into()),
            Some(p) => Cell::number(significant(p, 2)),
        };
        let mark = match (test.p_value, test.passed) {
            (None, _) => html! { "not tested" },
            (_, true) => html! { "passed" },
            (_, false) => html! { strong { "failed" } },
        };
        vec![
            Cell::text(&test.name),
            p_value,
            Cell::Text(mark),
            Cell::Sentence(sentence(&test.explanation)),
        ]
    };
    let rows: Vec<Vec<Cell>> = tests.iter().map(row).collect();
    html! { @if !rows.is_empty() { (table("", &["Test", "p", "", "What it says"], &rows)) } }
}

/// Residuals by what the measurement has several of.
fn left(found: &Discrepancy, noise: NoiseSource) -> Markup {
    let unit = if noise == NoiseSource::Estimated { "of the rest" } else { "sigmas" };
    let axes = [
        ("Magnitude", &found.by_magnitude),
        ("Harmonic", &found.by_harmonic),
        ("Frequency, Hz", &found.by_frequency),
        ("Run", &found.by_run),
    ];
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
            @for (axis, groups) in axes {
                @if !groups.is_empty() {
                    (table("", &[axis, unit, "response", "relative, %"], &rows(groups)))
                }
            }
        }
    }
}

fn rows(groups: &[ResidualGroup]) -> Vec<Vec<Cell>> {
    let row = |group: &ResidualGroup| {
        let [from, to] = [group.from, group.to].map(|end| super::words::number(end, 3));
        let range = if from == to { from } else { format!("{from} to {to}") };
        vec![
            Cell::text(range),
            Cell::number(digits(group.rms_sigmas, 3)),
            Cell::number(digits(group.rms_response, 3)),
            Cell::number(digits(100.0 * group.relative, 2)),
        ]
    };
    groups.iter().map(row).collect()
}
