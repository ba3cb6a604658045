//! Title and verdict: what a reader sees first.

use maud::{Markup, html};

use servoscope_core::answers::Answer;

use super::Content;
use crate::report::brief::{Judgement, Mark, judgement};

/// What the page is about.
pub(super) fn title(content: &Content<'_>) -> String {
    let what = match content.answer {
        Answer::Identification(_) => "Identification",
        Answer::Diagnosis(_) => "Diagnosis",
    };
    format!("{what} of {}", content.measured.subject())
}

/// Title, origin and verdict.
pub(super) fn header(content: &Content<'_>, title: &str) -> Markup {
    let Judgement { word, mark, text } = judgement(content.answer);
    let class = match mark {
        Mark::Good => "good",
        Mark::Part => "part",
        Mark::Bad => "bad",
        Mark::Open => "open",
    };
    let origin = content.measured.origin();
    html! {
        header {
            div.title {
                h1 { (title) }
                @if !origin.is_empty() { p.origin { (origin.join(" · ")) } }
            }
            div.verdict.(class) {
                p.word { (word) }
                p.lead { (text) }
            }
        }
    }
}
