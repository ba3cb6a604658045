//! Every effect that was tried, and why it is not the cause.

use maud::html;
use servoscope_core::answers::Candidate;

use crate::report::number::digits;

use super::table::{Cell, table};
use super::words::{effect, list, sentence, without_ids};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    if answer.candidates.is_empty() {
        return None;
    }
    let ids: Vec<&str> = answer.candidates.iter().map(|c| c.effect.as_str()).collect();
    let rows: Vec<Vec<Cell>> = answer.candidates.iter().map(|c| row(c, &ids)).collect();
    let titles = ["Effect", "Δχ²", "criterion", "held-out error, %", "What became of it"];
    let title = if answer.causes.is_empty() { "What was tried" } else { "The rivals" };
    let body = html! {
        p {
            "Each effect was fitted together with the whole base model. Δχ² is what it alone takes \
             off the misfit, the criterion weighs that against its parameters: the smallest wins."
        }
        (table("", &titles, &rows))
        @for cause in answer.causes.iter().filter(|cause| !cause.equivalents.is_empty()) {
            p {
                "Besides " (effect(&cause.effect)) ", this measurement leaves possible: "
                (list(cause.equivalents.iter().map(String::as_str), "and")) "."
            }
        }
    };
    Section::new("rivals", title, body)
}

/// Where a fit was given up before it came to as little as the base model
/// leaves, it has gained nothing.
fn row(candidate: &Candidate, ids: &[&str]) -> Vec<Cell> {
    let Candidate { effect: id, delta_chi2, criterion, heldout_error, rejected, .. } = candidate;
    let [gained, criterion] = match *delta_chi2 > 0.0 {
        true => [format!("{delta_chi2:.1}"), format!("{criterion:.1}")].map(Cell::number),
        false => [Cell::Number("none".into()), Cell::empty()],
    };
    let error = heldout_error.map_or_else(Cell::empty, |e| Cell::number(digits(100.0 * e, 3)));
    let what = match rejected {
        None => Cell::Text(html! { strong { "Named as a cause." } }),
        Some(why) => Cell::Sentence(sentence(&without_ids(why, ids.iter().copied()))),
    };
    vec![Cell::text(effect(id)), gained, criterion, error, what]
}
