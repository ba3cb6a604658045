//! Measured against simulated, before and after, and what that gains.

use maud::{Markup, html};
use servoscope_core::answers::{Gain, Identification};

use crate::report::causes::{gains, held_out};
use crate::report::tables;

use super::described::described;
use super::figure::figure;
use super::words::{number, per_cent, with_causes};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let name = with_causes(content.answer.causes());
    let subject = content.subject(&name);
    let extended = content.answer.extended();
    let bode = match extended {
        None => "Frequency response at each magnitude: dots are measured, lines simulated.",
        Some(_) => {
            "Frequency response at each magnitude: dots are measured, lines simulated with the \
             causes, dotted lines with the base model."
        }
    };
    let body = html! {
        (misfit(content.answer.base(), extended, &name))
        (figure("bode", &subject, "", bode))
        (figure("residuals-after", &subject, "-after", "What the model with the causes leaves of \
            every harmonic, drawn as the residuals before."))
    };
    Section::new("compared", "Measured against simulated", body)
}

/// What both models leave of the data they were fitted to.
fn misfit(base: &Identification, extended: Option<&Identification>, name: &str) -> Markup {
    let base = ("base model", &base.fit);
    let models = std::iter::once(base).chain(extended.map(|extended| (name, &extended.fit)));
    let caption = "What is left of the data the models were fitted to";
    described(caption, &tables::misfit(models), &[])
}

pub(super) fn gain(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer.diagnosis()?;
    let gains = gains(answer);
    let body = match (&answer.gain, answer.causes.is_empty()) {
        (_, true) => return None,
        (Some(gain), _) => html! { p.lead { (said(gain)) } },
        (None, _) if gains.is_empty() => html! {
            p {
                "The gain on data held out was not measured here. What the models leave above is of the data that \
                 they were fitted to, which an additional parameter always lowers."
            }
        },
        (None, _) => html! {},
    };
    let body = html! {
        (body)
        @if !gains.is_empty() {
            (described(
                "Error (NRMSE) of the base model and with the causes on what was held out",
                &tables::gains(&gains),
                &[],
            ))
            @for heldout in held_out(&gains) { p { "Held out: " (heldout.trim_end_matches('.')) "." } }
        }
    };
    Section::new("gain", "What it gains on data held out", body)
}

fn said(gain: &Gain) -> String {
    let [before, after] =
        [gain.heldout_nrmse_before, gain.heldout_nrmse_after].map(|error| per_cent(error, 3));
    let [low, high] = gain.interval95.map(|end| number(end, 3));
    let ratio = number(gain.ratio, 3);
    let verb = if gain.ratio < 1.0 { "grows" } else { "falls" };
    let chance = match gain.interval95[0] > 1.0 {
        true => "",
        false => ": no more than chance may make of it",
    };
    format!(
        "On data that neither a fit nor the choice of the cause has seen, the error {verb} from \
         {before} to {after} of the response, by a factor of {ratio} (95\u{a0}%: {low} to {high}){chance}."
    )
}
