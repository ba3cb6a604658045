//! What to measure next, and what this answer cannot tell.

use maud::html;

use servoscope_core::answers::Verdict;

use super::words::{quantity, sentence, without_ids};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    let ids = answer.candidates.iter().map(|candidate| candidate.effect.as_str());
    let body = match (&answer.next_experiment, answer.verdict) {
        (Some(next), _) => {
            let magnitude = quantity(next.magnitude, 4, &content.measured.input_unit);
            let hertz = quantity(next.omega_rad_s / std::f64::consts::TAU, 4, "Hz");
            let omega = quantity(next.omega_rad_s, 4, "rad/s");
            html! {
                p.lead { "Magnitude " (magnitude) " at " (hertz) " (" (omega) ")." }
                p { (sentence(&without_ids(&next.reason, ids))) }
            }
        }
        (None, Verdict::Adequate | Verdict::Explained) => html! {
            p { "Nothing is in doubt between the models that were tried: no further experiment is \
                 asked for." }
        },
        (None, Verdict::Improved | Verdict::Unexplained) => html! {
            p { "No single experiment separates the models that were tried. Where the patterns lie, \
                 more magnitudes, frequencies and harmonics show more of what is missing." }
        },
    };
    Section::new("next", "What to measure next", body)
}

pub(super) fn limits(content: &Content<'_>) -> Option<Section> {
    let of_diagnosis = content.answer.diagnosis().map_or(&[][..], |answer| &answer.limitations);
    let of_model = &content.answer.model().limitations;
    let said: Vec<&String> = of_diagnosis.iter().chain(of_model).collect();
    let of_base = content.answer.base().limitations.iter().filter(|text| !said.contains(text));
    let of_base = of_base.map(|text| match text.starts_with("the base model") {
        true => text.clone(),
        false => format!("of the base model: {text}"),
    });
    let texts: Vec<String> = said.iter().map(|text| (*text).clone()).chain(of_base).collect();
    let body = html! {
        @if texts.is_empty() {
            p { "Nothing was left out, and the data determines every parameter that was fitted." }
        } @else {
            ul { @for text in texts { li { (sentence(&text)) } } }
        }
        p.small {
            "An answer holds for the magnitudes and frequencies that were measured. Effects outside \
             the library can be seen, but not named."
        }
    };
    Section::new("limits", "What this cannot tell", body)
}
