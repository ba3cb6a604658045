//! Beside the response: what is wrong with the measurement, the cause, its improvement, and what to
//! do.

use maud::{Markup, html};
use servoscope_core::answers::{Answer, Cause, Diagnosis, Gain, ParameterEstimate, Verdict};
use servoscope_core::effects::fit_words;

use super::Content;
use super::words::{coded, confidence, effect, equation, parameter_name, probability, sentence};
use crate::report::brief::{self, Units};
use crate::report::causes::heading;
use crate::report::size;

/// Rows of the card on the axis, of a model without a cause and of one with.
const PARAMETERS: [&str; 5] = ["pole", "constant", "dc_gain", "fc_plus", "fc_minus"];

/// Every card that an answer has.
pub(super) fn cards(content: &Content<'_>) -> Markup {
    let answer = content.answer;
    let units = content.units();
    html! {
        div.cards {
            @if let Some(answer) = answer.diagnosis() { (faults(answer)) }
            (doubts(answer))
            @if let Some(answer) = answer.diagnosis() { (causes(answer, units)) }
            @if let Some(gain) = answer.diagnosis().and_then(|answer| answer.gain.as_ref()) {
                (gained(gain))
            }
            @if let Some(answer) = answer.diagnosis() { (unexplained(answer)) }
            @if answer.causes().is_empty() { (axis(content)) }
            (next(content))
        }
    }
}

fn card(class: &str, title: &str, body: Markup) -> Markup {
    html! { div.card.(class) { h2 { (title) } (body) } }
}

fn faults(answer: &Diagnosis) -> Markup {
    let (title, faults) = match (answer.measurement.len(), answer.rival_faults.len()) {
        (0, 0) => return html! {},
        (0, _) => ("Or a fault of the measurement", &answer.rival_faults),
        (1, _) => ("Fault of the measurement", &answer.measurement),
        _ => ("Faults of the measurement", &answer.measurement),
    };
    let body = html! {
        @for fault in faults {
            p { (coded(&sentence(&fault.sentence))) }
            p.small { "To correct it: " (coded(&fault.remedy)) "." }
        }
    };
    card("bad", title, body)
}

/// What looks wrong with the measurement, folded: what to do next stays on the first screen.
fn doubts(answer: &Answer) -> Markup {
    let doubts = &answer.base().doubts;
    let Some(first) = doubts.first() else { return html! {} };
    html! {
        details.card.bad {
            summary {
                h2 { "The measurement looks wrong" }
                span.short { (coded(&sentence(&first.sentence))) }
            }
            @for doubt in doubts {
                p { (coded(&sentence(&doubt.sentence))) }
                p.small { "To do: " (coded(&doubt.remedy)) "." }
            }
        }
    }
}

fn causes(answer: &Diagnosis, units: Units<'_>) -> Markup {
    let title = heading(&answer.causes);
    if answer.causes.is_empty() {
        return html! {};
    }
    let body = html! { @for found in &answer.causes { (cause(found, answer, units)) } };
    card("cause", title, body)
}

fn cause(cause: &Cause, answer: &Diagnosis, units: Units<'_>) -> Markup {
    let Cause { effect: id, confidence: sure, .. } = cause;
    let model = answer.extended.as_ref().unwrap_or(&answer.base);
    html! {
        div.one {
            p.name {
                strong { (sentence(&effect(id)).trim_end_matches('.')) }
                span.sure { (probability(*sure).replace(" %", "\u{a0}%")) ", " (confidence(*sure)) }
            }
            @if !is_aside(cause, answer) { (values(cause, units)) }
            @if let Some(said) = size::in_the_machine(cause, model) { p { (sentence(&said)) } }
            @if answer.causes.len() == 1 { p.small { (brief::meaning(cause, units)) } }
            @if let Some(said) = brief::equivalents(cause) { p.small { (said) } }
        }
    }
}

/// Whether a cause is but possible beside one that is likely. Its numbers are folded then: what to do
/// next stays on the first screen.
fn is_aside(cause: &Cause, answer: &Diagnosis) -> bool {
    brief::is_candidate(cause) && !answer.causes.iter().all(brief::is_candidate)
}

fn values(cause: &Cause, units: Units<'_>) -> Markup {
    html! {
        dl.values {
            @for (name, value) in size::values(cause) {
                div { dt { (sentence(&fit_words(&name, units.input, units.response)).trim_end_matches('.')) } dd { (value) } }
            }
        }
    }
}

/// The equation and how an effect shows, for whoever looks closer.
pub(super) fn closer(answer: &Diagnosis, units: Units<'_>) -> Markup {
    html! {
        @for cause in &answer.causes {
            // One cause alone is explained on the first screen.
            @if answer.causes.len() > 1 {
                p { strong { (sentence(&effect(&cause.effect))) } " " (brief::meaning(cause, units)) }
            }
            @if is_aside(cause, answer) { (values(cause, units)) }
            @if let Some(signature) = brief::signature(cause, units) {
                p { "How " (effect(&cause.effect)) " shows: " (signature) }
            }
            @if let Some(equation) = equation(&cause.effect) { p.equation { (equation) } }
        }
    }
}

/// Where a model is wrong for which no cause is known.
fn unexplained(answer: &Diagnosis) -> Markup {
    if answer.verdict != Verdict::Unexplained {
        return html! {};
    }
    card("where", "Where it is wrong", html! { p { (sentence(&answer.discrepancy.sentence)) } })
}

fn gained(gain: &Gain) -> Markup {
    let (factor, is_sure) = brief::factor(gain);
    let body = html! {
        p.name { strong { (sentence(&factor).trim_end_matches('.')) } span.sure { (brief::interval(gain)) } }
        p { (brief::before_and_after(gain)) " of the response, on held-out data." }
        @if !is_sure { p.small { "This improvement may be due to chance." } }
    };
    card("gain", "Improvement", body)
}

fn axis(content: &Content<'_>) -> Markup {
    let model = content.answer.model();
    let row = |id: &str| -> Option<(String, &ParameterEstimate)> {
        Some((parameter_name(id), model.parameters.get(id)?))
    };
    let left = crate::report::words::per_cent(model.fit.nrmse, 3);
    let body = html! {
        dl.values {
            @for (name, estimate) in PARAMETERS.iter().filter_map(|id| row(id)) {
                div { dt { (sentence(&name).trim_end_matches('.')) } dd { (size::with_interval(estimate)) } }
            }
            div { dt { "Residual" } dd { (left) " of the response" } }
        }
        @let judged = |answer: &&Diagnosis| answer.verdict == Verdict::Adequate && answer.is_tested();
        @if let Some(answer) = content.answer.diagnosis().filter(judged) {
            p.small { (sentence(&answer.discrepancy.sentence)) }
        }
    };
    card("axis", "The axis", body)
}

fn next(content: &Content<'_>) -> Markup {
    let texts = brief::next(content.answer, content.units());
    let body = html! { @for text in texts { p { (coded(&text)) } } };
    card("next", "What to do next", body)
}
