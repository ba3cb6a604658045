//! Every effect that was tried, and why it is not the cause.

use maud::html;

use crate::report::tables;

use super::described::described;
use super::words::{effect, list};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    if answer.candidates.is_empty() {
        return None;
    }
    let ids: Vec<&str> = answer.candidates.iter().map(|c| c.effect.as_str()).collect();
    let title = if answer.causes.is_empty() { "What was tried" } else { "The rivals" };
    let body = html! {
        p {
            "Each effect was fitted together with the whole base model. Δχ² is what it alone takes \
             off the misfit, the criterion weighs that against its parameters: the smallest wins."
        }
        (described("", &tables::tried(&answer.candidates), &ids))
        @for cause in answer.causes.iter().filter(|cause| !cause.equivalents.is_empty()) {
            p {
                "Besides " (effect(&cause.effect)) ", this measurement leaves possible: "
                (list(cause.equivalents.iter().map(String::as_str), "and")) "."
            }
        }
    };
    Section::new("rivals", title, body)
}
