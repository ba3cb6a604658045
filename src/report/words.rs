//! Names, numbers and confidence in words.

use maud::{Markup, html};
use servoscope_core::answers::Cause;
use servoscope_core::effects::{self, find, find_parameter};

use super::figures::superscript;

/// A number as it is printed: a true minus sign, and a power of ten.
pub(in crate::report) fn typeset(number: &str) -> String {
    let number = number.replace('-', "−");
    match number.split_once('e') {
        Some((mantissa, power)) => format!("{mantissa}·10{}", superscript(power)),
        None => number,
    }
}

/// A number with at most so many significant digits.
pub(in crate::report) fn number(value: f64, digits: usize) -> String {
    typeset(&super::number::significant(value, digits))
}

/// A share as per cent with so many significant digits.
pub(in crate::report) fn per_cent(share: f64, digits: usize) -> String {
    format!("{}\u{a0}%", typeset(&super::number::digits(100.0 * share, digits)))
}

/// A number with its unit, where there is one.
pub(in crate::report) fn quantity(value: f64, digits: usize, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { "\u{a0}" };
    format!("{}{space}{unit}", number(value, digits))
}

/// A sentence: begins with a capital, unless with an id, and ends with a stop.
pub(in crate::report) fn sentence(text: &str) -> String {
    let text = text.trim();
    let first_word = text.split_whitespace().next().unwrap_or_default();
    let mut characters = text.chars();
    let mut sentence = match characters.next() {
        Some(first) if !first_word.contains('_') => {
            first.to_uppercase().chain(characters).collect()
        }
        _ => text.to_owned(),
    };
    if !sentence.is_empty() && !sentence.ends_with(['.', '!', '?']) {
        sentence.push('.');
    }
    sentence.replace(" %", "\u{a0}%")
}

/// A text in which what stands between backquotes is code.
pub(in crate::report) fn coded(text: &str) -> Markup {
    html! {
        @for (place, part) in text.split('`').enumerate() {
            @if place % 2 == 0 { (part) } @else { code { (part) } }
        }
    }
}

/// An id as words: `static_friction` is static friction.
pub(in crate::report) fn effect(id: &str) -> String {
    match find(id) {
        Some(effect) => effect.descriptor().title.to_owned(),
        None => id.replace('_', " "),
    }
}

/// The same as something that an axis has: a spring, but backlash.
pub(in crate::report) fn a(id: &str) -> String {
    match find(id) {
        Some(effect) => effect.descriptor().with_article.to_owned(),
        None => effect(id),
    }
}

/// The equation of an effect.
pub(in crate::report) fn equation(id: &str) -> Option<&'static str> {
    find(id).map(|effect| effect.descriptor().equation)
}

/// A text of a diagnosis with these ids as words.
pub(in crate::report) fn without_ids<'a>(
    text: &str,
    ids: impl IntoIterator<Item = &'a str>,
) -> String {
    // The longest first: one id may be part of another.
    let mut ids: Vec<&str> = ids.into_iter().collect();
    ids.sort_by_key(|id| std::cmp::Reverse(id.len()));
    ids.into_iter().fold(text.to_owned(), |text, id| text.replace(id, &effect(id)))
}

/// What the model with the causes is called: `with Stribeck friction and backlash`.
pub fn with_causes(causes: &[Cause]) -> String {
    format!("with {}", list(causes.iter().map(|cause| cause.effect.as_str()), "and"))
}

/// Effects as they are said: one, one and another, one, another and a third.
pub(in crate::report) fn list<'a>(ids: impl IntoIterator<Item = &'a str>, last: &str) -> String {
    joined(ids.into_iter().map(effect).collect(), last)
}

/// Names with commas, and a word before the last.
pub(in crate::report) fn joined(mut names: Vec<String>, last: &str) -> String {
    match names.pop() {
        Some(name) if names.is_empty() => name,
        Some(name) => format!("{} {last} {name}", names.join(", ")),
        None => String::new(),
    }
}

/// Name, symbol and subscript of a parameter.
fn known(id: &str) -> Option<(&'static str, [&'static str; 2])> {
    if let Some((_, parameter)) = find_parameter(id) {
        return Some((parameter.title, parameter.symbol));
    }
    Some(match id {
        "pole" => ("pole", ["−a", ""]),
        "constant" => ("constant", ["K", ""]),
        "dc_gain" => ("DC gain", ["K/a", ""]),
        "fc_plus" => ("dry friction forwards", ["F", "c+"]),
        "fc_minus" => ("dry friction backwards", ["F", "c−"]),
        "actuator_pole" => ("actuator pole", ["−p", ""]),
        "natural_frequency" => ("actuator natural frequency", ["ω", "n"]),
        "damping_ratio" => ("actuator damping ratio", ["ζ", ""]),
        _ => return None,
    })
}

/// What the parameter of this id is called.
pub fn parameter_name(id: &str) -> String {
    known(id).map_or_else(|| id.to_owned(), |(name, _)| name.to_owned())
}

/// Parameters of the base model by id.
const BASE: [&str; 8] = [
    "pole",
    "constant",
    "dc_gain",
    "fc_plus",
    "fc_minus",
    "actuator_pole",
    "natural_frequency",
    "damping_ratio",
];

/// Every parameter by its id, with what it is called at the beginning of a line.
pub fn parameter_names() -> impl Iterator<Item = (String, String)> {
    let of_effects = effects::ALL
        .iter()
        .flat_map(|effect| effect.parameters().iter().map(move |parameter| effect.key(parameter)));
    let ids = BASE.iter().map(|id| (*id).to_owned()).chain(of_effects);
    ids.map(|id| {
        let name = sentence(&parameter_name(&id));
        (id, name.trim_end_matches('.').to_owned())
    })
}

/// What a parameter is called, with its symbol, beside its id.
pub(in crate::report) fn parameter(id: &str) -> Markup {
    let Some((name, [symbol, index])) = known(id) else {
        return html! { code { (id) } };
    };
    html! {
        (name) " " i.symbol { (symbol) @if !index.is_empty() { sub { (index) } } }
        @if name != id { " " code { (id) } }
    }
}

/// Probability above which another digit says nothing.
const ALL_BUT_CERTAIN: f64 = 0.999;

/// A probability that is never rounded up, to certainty or to a word beyond its own.
pub(in crate::report) fn probability(probability: f64) -> String {
    if probability > ALL_BUT_CERTAIN {
        return format!("above {} %", number(100.0 * ALL_BUT_CERTAIN, 3));
    }
    let decimals = usize::from(probability > 0.99);
    let shift = 10f64.powi(decimals as i32);
    // What differs from a whole number by rounding alone is one.
    let cut = (100.0 * shift * probability + 1e-9).floor() / shift;
    format!("{cut:.decimals$} %")
}

/// A probability as a person says it. The limits are those between which the
/// benchmark counts how often a cause of that confidence is right.
pub(in crate::report) fn confidence(probability: f64) -> &'static str {
    match probability {
        p if p >= 0.99 => "all but certain",
        p if p >= 0.9 => "very likely",
        p if p >= 0.8 => "likely",
        p if p >= 0.5 => "more likely than not",
        _ => "possible",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_begins_with_a_capital_but_an_id_stays_as_it_is() {
        assert_eq!(sentence("the mean is 3 % larger"), "The mean is 3\u{a0}% larger.");
        assert_eq!(sentence("slew_limit explains it."), "slew_limit explains it.");
        assert_eq!(sentence(""), "");
    }

    #[test]
    fn what_stands_between_backquotes_is_code() {
        let html = coded("say so: `--loop closed`, or <not>").into_string();
        assert_eq!(html, "say so: <code>--loop closed</code>, or &lt;not&gt;");
    }

    #[test]
    fn names_are_joined_as_they_are_said() {
        assert_eq!(list(["spring"], "and"), "spring");
        assert_eq!(list(["spring", "stribeck"], "or"), "spring or Stribeck friction");
        assert_eq!(list(["a", "b_c", "d"], "and"), "a, b c and d");
        assert_eq!(list([], "and"), "");
        let had = ["backlash", "spring", "actuator_dead_zone"].map(a);
        assert_eq!(joined(had.into(), "and"), "backlash, a spring and an actuator dead zone");
    }

    #[test]
    fn ids_in_a_text_become_words() {
        let text = "hardening_spring explains the data better, a spring does not";
        assert_eq!(
            without_ids(text, ["spring", "hardening_spring"]),
            "hardening spring explains the data better, a spring does not"
        );
    }

    #[test]
    fn numbers_have_true_minus_signs_and_powers() {
        assert_eq!(typeset("-1.02e-7"), "−1.02·10⁻⁷");
        assert_eq!(quantity(-0.5, 2, "A"), "−0.5\u{a0}A");
    }

    #[test]
    fn a_parameter_is_called_by_its_name_and_symbol() {
        let shown = parameter("slew_limit.rate").into_string();
        assert_eq!(
            shown,
            "limit of the rate of the input <i class=\"symbol\">R</i> <code>slew_limit.rate</code>"
        );
        assert_eq!(parameter("pole").into_string(), "pole <i class=\"symbol\">−a</i>");
        assert!(parameter("fc_plus").into_string().contains("<sub>c+</sub>"));
        assert_eq!(
            parameter("of_a_later_version").into_string(),
            "<code>of_a_later_version</code>"
        );
    }

    #[test]
    fn no_confidence_is_rounded_to_certainty() {
        let written = [0.29, 0.898, 0.9946, 0.99996, 1.0].map(probability);
        assert_eq!(written, ["29 %", "89 %", "99.4 %", "above 99.9 %", "above 99.9 %"]);
    }
}
