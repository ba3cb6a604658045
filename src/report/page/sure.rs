//! How sure an answer is: the improvement on held-out data, the tests, and its limits.

use maud::{Markup, html};
use servoscope_core::answers::{Answer, Diagnosis, Identification};

use super::described::described;
use super::words::{coded, number, per_cent, probability, sentence, with_causes};
use super::{Content, Section};
use crate::report::brief::{factor, interval};
use crate::report::causes::{gains, held_out, without};
use crate::report::measurement;
use crate::report::tables;

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer;
    let name = with_causes(answer.causes());
    let body = html! {
        @if let Some(answer) = answer.diagnosis() { (gain(answer)) }
        (misfit(answer.base(), answer.extended(), &name))
        @if let Some(answer) = answer.diagnosis() {
            @for text in measurement::without(answer) { p { (sentence(&text)) } }
            @if !answer.discrepancy.tests.is_empty() {
                h3 { "Is the residual of the base model noise?" }
                p { "Each test compares it with noise; " i { "p" } " is the probability that noise \
                    alone looks at least as bad." }
                (described("", &tables::tests(&answer.discrepancy.tests), &[]))
            }
        }
        h3 { "Limits of this answer" }
        (limits(answer))
    };
    Section::new("sure", "How sure?", short(answer), body)
}

fn short(answer: &Answer) -> String {
    let each = |of: &Identification| match of.fit.chi2_per_dof {
        Some(each) => format!("χ² per degree of freedom {}, 1 is noise", number(each, 3)),
        None => "the noise is not known".to_owned(),
    };
    let Some(diagnosis) = answer.diagnosis() else { return each(answer.base()) };
    let held_out = diagnosis
        .gain
        .as_ref()
        .map(|gain| format!("{} on held-out data ({})", factor(gain).0, interval(gain)));
    let sure: Vec<String> =
        diagnosis.causes.iter().map(|cause| probability(cause.confidence)).collect();
    match (sure.is_empty(), held_out) {
        (true, _) => each(answer.base()),
        (false, Some(held_out)) => format!("{}; {held_out}", sure.join(" and ")),
        (false, None) => {
            format!("{}; the improvement on held-out data was not measured", sure.join(" and "))
        }
    }
    .replace(" %", "\u{a0}%")
}

fn gain(answer: &Diagnosis) -> Markup {
    let gains = gains(answer);
    html! {
        @for cause in &answer.causes {
            @if let Some(margin) = without(cause.margin) { p { (sentence(&margin)) } }
        }
        @if gains.is_empty() && !answer.causes.is_empty() {
            p { "The residuals below are of the data that the models were fitted to, which an \
                additional parameter always lowers." }
        }
        @if !gains.is_empty() {
            (described(
                "Residual (NRMSE) of the base model and with the causes on held-out data",
                &tables::gains(&gains),
                &[],
            ))
            @for heldout in held_out(&gains) { p { "Held out: " (heldout.trim_end_matches('.')) "." } }
        }
    }
}

/// Residual of both models on the data that they were fitted to.
fn misfit(base: &Identification, extended: Option<&Identification>, name: &str) -> Markup {
    let base = ("base model", &base.fit);
    let models = std::iter::once(base).chain(extended.map(|extended| (name, &extended.fit)));
    let caption = "Residual on the data that the models were fitted to";
    described(caption, &tables::misfit(models), &[])
}

fn limits(answer: &Answer) -> Markup {
    let of_diagnosis = answer.diagnosis().map_or(&[][..], |answer| &answer.limitations);
    let said: Vec<&String> = of_diagnosis.iter().chain(&answer.model().limitations).collect();
    let of_base = answer.base().limitations.iter().filter(|text| !said.contains(text));
    let of_base = of_base.map(|text| match text.starts_with("the base model") {
        true => text.clone(),
        false => format!("of the base model: {text}"),
    });
    let texts: Vec<String> = said.iter().map(|text| (*text).clone()).chain(of_base).collect();
    html! {
        @if texts.is_empty() {
            p { "Nothing was left out, and the data determines every parameter that was fitted." }
        } @else {
            ul { @for text in texts { li { (coded(&sentence(&text))) } } }
        }
        p.small {
            "An answer holds for the magnitudes and frequencies that were measured. Effects outside \
             the library can be seen, but not named. The residual of the fit is "
            (per_cent(answer.model().fit.nrmse, 3)) " of the response."
        }
    }
}
