//! The model: transfer function, parameters, and how they were computed.

use maud::{Markup, html};
use servoscope_core::answers::{Identification, OrderChoice};

use crate::report::figures::Subject;
use crate::report::tables;
use crate::report::text::{coefficient_digits, stages};

use super::described::described;
use super::figure::figure;
use super::words::{number, sentence, with_causes};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer;
    let name = with_causes(answer.causes());
    let moved = Subject {
        identification: Some(answer.model()),
        comparison: content.extended.or(content.comparison),
        ..Subject::default()
    };
    let body = html! {
        (transfer_function(answer.model()))
        @match answer.extended() {
            None => (estimates(answer.base())),
            Some(extended) => {
                h3 { "Parameters " (name) }
                (estimates(extended))
                h3 { "Parameters of the base model" }
                p { "Without the causes these parameters absorb what is missing." }
                (estimates(answer.base()))
            }
        }
        (figure("friction", &moved, "", "Friction of this model over velocity, and the range in \
            which the measurement moved."))
    };
    Section::new("model", "The model", body)
}

fn estimates(answer: &Identification) -> Markup {
    described("", &tables::parameters(&answer.parameters, ""), &[])
}

fn transfer_function(answer: &Identification) -> Markup {
    let digits = coefficient_digits(answer);
    let function = &answer.transfer_function;
    let poles = function.poles.iter().filter(|[_, im]| *im >= 0.0).map(|&[re, im]| {
        let re = number(re, digits);
        if im == 0.0 { re } else { format!("{re} ± {}j", number(im, digits)) }
    });
    html! {
        p.formula {
            i { "G" } "(" i { "s" } ") = "
            span.fraction {
                span { (polynomial(&function.numerator, digits)) }
                span { (polynomial(&function.denominator, digits)) }
            }
        }
        p {
            "From command to velocity, without friction. Poles: "
            (poles.collect::<Vec<_>>().join(", ")) " rad/s."
        }
    }
}

/// A polynomial in s from its coefficients, highest power first.
fn polynomial(coefficients: &[f64], digits: usize) -> Markup {
    let term = |(index, &coefficient): (usize, &f64)| {
        let power = coefficients.len() - 1 - index;
        let sign = match (index, coefficient < 0.0) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => " + ",
            (_, true) => " − ",
        };
        let size = coefficient.abs();
        html! {
            (sign)
            @if size != 1.0 || power == 0 {
                (number(size, digits)) @if power > 0 { "\u{a0}" }
            }
            @if power > 0 { i { "s" } }
            @if power > 1 { sup { (power) } }
        }
    };
    html! { @for term in coefficients.iter().enumerate().map(term) { (term) } }
}

pub(super) fn computed(content: &Content<'_>) -> Option<Section> {
    let model = content.answer.model();
    let (of_model, others) = stages(model);
    let evaluations: u64 = others.iter().map(|stage| stage.evaluations).sum();
    let seconds: f64 = others.iter().map(|stage| stage.seconds).sum();
    let subject = content.subject("");
    let body = html! {
        @if let Some(choice) = &model.order_choice { (order(choice, model)) }
        h3 { "Stages" }
        (described("", &tables::stages(&of_model, &model.fit), &[]))
        @if !others.is_empty() {
            p.small { "The other orders of the actuator took " (evaluations) " evaluations and "
                (format!("{seconds:.2}")) " s." }
        }
        (figure("convergence", &subject, "", "How the base model's misfit fell, stage by stage."))
    };
    Section::new("computed", "How it was computed", body)
}

fn order(choice: &OrderChoice, answer: &Identification) -> Markup {
    html! {
        h3 { "Order of the actuator" }
        p { (sentence(&choice.explanation)) }
        (described("", &tables::orders(choice, &answer.fit), &[]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_set_as_it_is_written_by_hand() {
        let text = polynomial(&[1.0, -2.5, 0.5], 3).into_string();
        assert_eq!(text, "<i>s</i><sup>2</sup> − 2.5\u{a0}<i>s</i> + 0.5");
    }
}
