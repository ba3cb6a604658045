//! Where the simulation departs from the measurement, before and after.

use maud::{Markup, html};
use servoscope_core::answers::{Diagnosis, Discrepancy, NoiseSource, Pattern};

use crate::report::tables;

use super::cards::closer;
use super::described::described;
use super::figure::figure;
use super::table::{Cell, table};
use super::words::{number, per_cent, quantity, sentence, with_causes};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let name = with_causes(content.answer.causes());
    let subject = content.subject(&name);
    let figures = html! {
        (figure("residuals", &subject, "", "Residual of the base model in every harmonic, over its \
            noise."))
        (figure("residuals-after", &subject, "-after", "Residual of the model with the causes, \
            drawn in the same way."))
    };
    let Some(answer) = content.answer.diagnosis() else {
        if figures.0.is_empty() {
            return None;
        }
        let left = per_cent(content.answer.base().fit.nrmse, 3);
        let short = format!("the residual is {left} of the response");
        return Section::new("departure", "Where is it wrong?", short, figures);
    };
    let found = &answer.discrepancy;
    let body = html! {
        // The figure lists them, too.
        @if content.comparison.is_none() { (patterns(&found.patterns)) }
        (closer(answer, content.units()))
        (figures)
        h3 { "Residual, part by part" }
        (left(found, answer.base.noise))
    };
    Section::new("departure", "Where is it wrong?", short(content, answer), body)
}

/// Where most of the misfit lies.
fn short(content: &Content<'_>, answer: &Diagnosis) -> String {
    let Some(first) = answer.discrepancy.patterns.first() else {
        return match answer.discrepancy.noise_like {
            true => "nowhere beyond the noise".to_owned(),
            false => "everywhere: no pattern stands out".to_owned(),
        };
    };
    let range = |[low, high]: [f64; 2], unit: &str| match number(low, 3) == number(high, 3) {
        true => quantity(low, 3, unit),
        false => format!("{} to {}", number(low, 3), quantity(high, 3, unit)),
    };
    let magnitudes =
        first.magnitudes.map(|ends| format!("at magnitude {}", range(ends, content.units().input)));
    let frequencies = first.frequencies_hz.map(|ends| format!("from {}", range(ends, "Hz")));
    let harmonics = match first.harmonics.as_slice() {
        [one] => Some(format!("in harmonic {one}")),
        _ => None,
    };
    let parts = [magnitudes, frequencies, harmonics].into_iter().flatten().collect::<Vec<_>>();
    let share = format!("{:.0}\u{a0}% of the excess χ² lies", 100.0 * first.share);
    match parts.is_empty() {
        true => format!("{share} in one pattern"),
        false => format!("{share} {}", parts.join(", ")),
    }
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
    html! { @if !rows.is_empty() { (table("Patterns, largest share of the excess χ² first", &titles, &rows)) } }
}

/// Residuals by what the measurement has several of.
fn left(found: &Discrepancy, noise: NoiseSource) -> Markup {
    html! {
        p {
            @match noise {
                NoiseSource::Estimated => {
                    "Root mean squares of the residual of the base model: over that of the whole \
                     residual, in units of the response, and as a share of what was measured."
                }
                _ => {
                    "Root mean squares of the residual of the base model: over the noise (1 is \
                     noise), in units of the response, and as a share of what was measured."
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
