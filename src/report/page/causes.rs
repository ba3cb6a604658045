//! What the simulation misses.

use maud::{Markup, html};
use servoscope_core::answers::{Cause, Verdict};

use crate::report::causes::{per_cent, without};
use crate::report::tables;

use super::described::described;
use super::words::{confidence, effect, equation, list, sentence};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    let title = if answer.causes.len() > 1 { "The causes" } else { "The cause" };
    if answer.causes.is_empty() {
        let text = match answer.verdict {
            Verdict::Adequate => return None,
            _ => {
                "None of the effects in the library gains more than chance makes any effect gain. \
                 What the simulation misses is something the library does not have; the patterns \
                 above say where to look for it."
            }
        };
        return Section::new("causes", title, html! { p { (text) } });
    }
    let body = html! {
        @if answer.verdict == Verdict::Improved {
            p {
                "Something remains that is not explained. What the library lacks looks like what \
                 it has, so take a cause for a good lead, and confirm it at the machine."
            }
        }
        @for cause in &answer.causes { (article(cause)) }
    };
    Section::new("causes", title, body)
}

fn article(cause: &Cause) -> Markup {
    let Cause { effect: id, parameters, confidence: probability, explanation, .. } = cause;
    html! {
        article {
            h3 { (sentence(&effect(id)).trim_end_matches('.')) " " code { (id) } }
            p.sure {
                strong { (per_cent(*probability)) } " — " (confidence(*probability))
            }
            p { (sentence(explanation)) }
            @if let Some(equation) = equation(id) { p.equation { (equation) } }
            (described("", &tables::parameters(parameters, &format!("{id}.")), &[]))
            @if let Some(margin) = without(cause.margin) { p { (sentence(&margin)) } }
            @if !cause.equivalents.is_empty() {
                p {
                    "This measurement cannot tell it from "
                    (list(cause.equivalents.iter().map(String::as_str), "or")) "."
                }
            }
        }
    }
}
