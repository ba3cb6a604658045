//! The model: transfer function, parameters, and how they were computed.

use maud::{Markup, html};
use servoscope_core::answers::{Identification, OrderChoice, Stage};

use crate::report::size::with_interval;
use crate::report::tables;
use crate::report::text::{coefficient_digits, stages};

use super::described::described;
use super::figure::figure;
use super::words::{number, parameter_name, sentence, with_causes};
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let answer = content.answer;
    let name = with_causes(answer.causes());
    let body = html! {
        (transfer_function(answer.model()))
        @match answer.extended() {
            None => (estimates(answer.base())),
            Some(extended) => {
                h3 { "Parameters " (name) }
                (estimates(extended))
                h3 { "Parameters of the base model" }
                p { "These parameters are biased by the causes that the base model lacks." }
                (estimates(answer.base()))
            }
        }
    };
    Section::new("model", "Parameters", short(answer.model()), body)
}

/// Pole, constant and levels of friction.
fn short(model: &Identification) -> String {
    let said = ["pole", "constant"].into_iter().filter_map(|id| {
        let estimate = model.parameters.get(id)?;
        Some(format!("{} {}", parameter_name(id), with_interval(estimate)))
    });
    said.collect::<Vec<_>>().join(", ")
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
            "From input to velocity, without friction. Poles: "
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
    let evaluations = Stage::evaluations_of(others.iter().copied());
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
        (figure("convergence", &subject, "", "How the cost of the base model fell, stage by stage."))
    };
    let all = Stage::evaluations_of(others.into_iter().chain(of_model.iter().map(|(_, own)| *own)));
    let order = model.order_choice.as_ref().map(|choice| choice.actuator_order);
    let order = order.map_or(String::new(), |order| format!(", actuator of order {order}"));
    let short = format!("{all} simulations of the model{order}");
    Section::new("computed", "Convergence", short, body)
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
