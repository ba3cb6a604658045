//! Faults of the measurement.

use maud::html;

use super::words::sentence;
use super::{Content, Section};
use crate::report::measurement;

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    if answer.measurement.is_empty() {
        return None;
    }
    let body = html! {
        ul {
            @for fault in &answer.measurement {
                li {
                    p.lead { (sentence(&fault.sentence)) }
                    p { "To mend it: " (fault.remedy) "." }
                }
            }
        }
        @for text in measurement::without(answer) { p { (sentence(&text)) } }
    };
    Section::new("measurement", "Faults of the measurement", body)
}
