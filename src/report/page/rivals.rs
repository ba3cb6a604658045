//! What else the cause could be: every effect that was tried, and why it is not named.

use maud::html;
use servoscope_core::answers::Diagnosis;

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
    let body = html! {
        p { (tables::TRIED_SAYS) }
        (described("", &tables::tried(&answer.candidates), &ids))
    };
    let title = if answer.causes.is_empty() { "What was tried" } else { "What else could it be?" };
    Section::new("rivals", title, short(answer), body)
}

fn short(answer: &Diagnosis) -> String {
    let tried = answer.candidates.len();
    let equivalents: Vec<&str> =
        answer.causes.iter().flat_map(|cause| &cause.equivalents).map(String::as_str).collect();
    if answer.causes.is_empty() {
        return format!("{tried} effects were tried, none is named");
    }
    if !equivalents.is_empty() {
        return format!("{} cannot be told from it", list(equivalents, "or"));
    }
    let nearest = answer.candidates.iter().find(|candidate| candidate.rejected.is_some());
    match nearest {
        Some(rival) => {
            format!("{tried} effects were tried; the runner-up is {}", effect(&rival.effect))
        }
        None => format!("{tried} effects were tried"),
    }
}
