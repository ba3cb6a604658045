//! An identification as plain text for a terminal.

use std::fmt::Write as _;

use servoscope_core::answers::{
    Fit, Identification, NoiseLaw, NoisePart, NoiseSource, OrderChoice, ParameterEstimate, Stage,
    TransferFunction,
};

use super::brief;
use super::columns::{Side, table};
use super::number::{Rounding, significant};
use super::tables;
use super::written::lines;

/// Writes an identification the way it is read: whether the model can be
/// trusted, what to mind, what was found, and how.
pub fn identification(answer: &Identification) -> String {
    let mut sections = vec![section(&brief::of_fit(answer).headline(), fit(answer))];
    if !answer.doubts.is_empty() {
        let lines = answer.doubts.iter().map(|found| format!("- {}", brief::doubt(found)));
        sections.push(section("The measurement looks wrong", lines.collect()));
    }
    if !answer.limitations.is_empty() {
        let lines = answer.limitations.iter().map(|text| format!("- {text}"));
        sections.push(section("Limitations", lines.collect()));
    }
    let parameters = tables::parameters(&answer.parameters, "");
    sections.push(section("Parameters", lines(&parameters)));
    sections.push(section("Transfer function", transfer_function(answer)));
    if let Some(choice) = &answer.order_choice {
        sections.push(section("Actuator order", order(choice, answer)));
    }
    sections.push(section("Stages", stage_lines(answer)));
    let provenance = &answer.provenance;
    sections.push(format!(
        "servoscope {}, method {}, seed {}, data {:.12}\n",
        provenance.software_version,
        answer.method.name(),
        answer.seed,
        provenance.data_sha256,
    ));
    sections.join("\n")
}

/// A title and its lines.
pub(super) fn section(title: &str, lines: Vec<String>) -> String {
    lines.into_iter().fold(format!("{title}\n"), |mut text, line| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {line}");
        text
    })
}

fn fit(answer: &Identification) -> Vec<String> {
    let Fit { chi2, dof, chi2_per_dof, nrmse, .. } = answer.fit;
    let noise = match answer.noise {
        NoiseSource::Given => "as given",
        NoiseSource::Repeats => "the scatter of the repeats",
        NoiseSource::Periods => "the scatter from period to period",
        NoiseSource::Estimated => "estimated from the residual",
    };
    let mut rows = vec![
        [
            "residual".to_owned(),
            format!("{} % of the response (NRMSE)", significant(100.0 * nrmse, 3)),
        ],
        ["noise".to_owned(), noise.to_owned() + &law(answer.fit.noise_law.as_ref())],
    ];
    if let (Some(chi2), Some(each)) = (chi2, chi2_per_dof) {
        let (chi2, each) = (significant(chi2, 4), significant(each, 3));
        let text = format!("{chi2} for {dof} degrees of freedom, {each} per degree of freedom");
        rows.insert(1, ["χ²".to_owned(), text]);
    }
    table(&[Side::Left, Side::Left], &rows)
}

/// How the noise depends on the size of the response, where that was estimated.
fn law(found: Option<&NoiseLaw>) -> String {
    let Some(NoiseLaw { additive, proportional }) = found else { return String::new() };
    let written = |part: &NoisePart, factor: f64, unit: &str| {
        let value = significant(factor * part.value, 2);
        let [low, high] = part.interval95.map(|end| significant(factor * end, 2));
        format!("{value}{unit} ({low} to {high})")
    };
    let alone = written(additive, 1.0, "");
    match proportional.value > 0.0 {
        true => format!(
            ": {} of each harmonic and, beside it, {alone}, in units of the response",
            written(proportional, 100.0, " %")
        ),
        false => format!(": {alone}, in units of the response, whatever its size"),
    }
}

/// Digits that the coefficients of the transfer function deserve.
pub(super) fn coefficient_digits(answer: &Identification) -> usize {
    let digits = |estimate: &ParameterEstimate| {
        let (value, std) = estimate.value.zip(estimate.std)?;
        Some(Rounding::of(value, std)?.digits(value))
    };
    // The best known parameter's: each coefficient mixes several.
    answer.parameters.values().filter_map(digits).max().unwrap_or(3).clamp(3, 6)
}

fn transfer_function(answer: &Identification) -> Vec<String> {
    let digits = coefficient_digits(answer);
    let TransferFunction { numerator, denominator, poles, .. } = &answer.transfer_function;
    let [numerator, denominator] = [numerator, denominator].map(|p| polynomial(p, digits));
    let poles = poles.iter().filter(|[_, im]| *im >= 0.0).map(|&[re, im]| {
        let re = significant(re, digits);
        if im == 0.0 { re } else { format!("{re} ± {}j", significant(im, digits)) }
    });
    let poles = poles.collect::<Vec<_>>().join(", ");
    vec![format!("G(s) = {numerator} / ({denominator})"), format!("poles  {poles} rad/s")]
}

fn order(choice: &OrderChoice, answer: &Identification) -> Vec<String> {
    let tried = lines(&tables::orders(choice, &answer.fit));
    std::iter::once(choice.explanation.clone()).chain(tried).collect()
}

/// The stages of the model that is reported, with their names in words, and
/// those of other orders of its actuator.
pub(super) fn stages(answer: &Identification) -> (Vec<(String, &Stage)>, Vec<&Stage>) {
    // Where several orders were tried, a stage says in its name which it is of.
    let chosen = answer.order_choice.as_ref().map(|choice| choice.actuator_order);
    let suffix = chosen.map(|order| format!(" (order {order})")).unwrap_or_default();
    let of_none = |stage: &Stage| !stage.name.contains(" (order ");
    let (of_chosen, others): (Vec<&Stage>, Vec<&Stage>) =
        answer.stages.iter().partition(|stage| stage.name.ends_with(&suffix) || of_none(stage));
    let name = |stage: &Stage| stage.name.trim_end_matches(&suffix).replace('_', " ");
    (of_chosen.into_iter().map(|stage| (name(stage), stage)).collect(), others)
}

fn stage_lines(answer: &Identification) -> Vec<String> {
    let (of_chosen, others) = stages(answer);
    let mut lines = lines(&tables::stages(&of_chosen, &answer.fit));
    if !others.is_empty() {
        let evaluations = Stage::evaluations_of(others.iter().copied());
        let seconds: f64 = others.iter().map(|stage| stage.seconds).sum();
        lines.push(format!("the other orders: {evaluations} evaluations, {seconds:.2} s"));
    }
    lines
}

/// A polynomial in s from its coefficients, highest power first.
fn polynomial(coefficients: &[f64], digits: usize) -> String {
    let mut text = String::new();
    for (index, &coefficient) in coefficients.iter().enumerate() {
        let power = coefficients.len() - 1 - index;
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = coefficient.abs();
        let factor =
            if size == 1.0 && power > 0 { String::new() } else { significant(size, digits) };
        let variable = match power {
            0 => String::new(),
            1 => "s".to_owned(),
            _ => format!("s^{power}"),
        };
        let space = if factor.is_empty() || variable.is_empty() { "" } else { " " };
        let _ = write!(text, "{sign}{factor}{space}{variable}");
    }
    text
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    /// The words of the first line that begins with `word`.
    fn words<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
        let mut lines = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        lines.find(|words| words.first() == Some(&word)).unwrap_or_else(|| panic!("{text}"))
    }

    #[test]
    fn a_parameter_is_one_line_with_deviation_interval_and_unit() {
        let text = identification(&sample::identification());
        assert_eq!(
            words(&text, "pole"),
            ["pole", "-10.020", "0.031", "-10.081", "-9.959", "rad/s"]
        );
    }

    #[test]
    fn what_the_data_cannot_tell_is_said_not_shown_as_a_number() {
        let text = identification(&sample::identification());
        assert_eq!(words(&text, "fc_minus")[1..4], ["unknown", "A", "not"]);
        assert!(words(&text, "fc_plus").ends_with(&["of", "the", "search", "range"]));
    }

    #[test]
    fn the_verdict_comes_first_and_what_to_mind_before_any_number() {
        let mut answer = sample::identification();
        for (adequate, p_value, begin) in [
            (Some(true), Some(0.5), "ADEQUATE: The model explains the measurement"),
            (
                Some(false),
                Some(1e-6),
                "NOT ADEQUATE: The residual of the model is larger than the noise",
            ),
            (Some(false), Some(0.5), "NOT ADEQUATE: The residual is larger than the simulated"),
            (None, None, "NOT TESTED: There are too few data to test this model."),
        ] {
            (answer.fit.adequate, answer.fit.p_value) = (adequate, p_value);
            assert!(identification(&answer).starts_with(begin));
        }
        let text = identification(&answer);
        let position = |part: &str| text.find(part).unwrap();
        assert!(position("- One magnitude only") < position("Parameters"));
        assert_eq!(words(&text, "residual")[1..3], ["1.23", "%"]);
    }

    #[test]
    fn noise_that_was_estimated_is_said_to_grow_with_the_response_or_not() {
        let part = |value: f64| NoisePart { value, interval95: [0.4 * value, 2.0 * value] };
        let law =
            |proportional| NoiseLaw { additive: part(5e-4), proportional: part(proportional) };
        assert_eq!(
            super::law(Some(&law(0.0025))),
            ": 0.25 % (0.1 to 0.5) of each harmonic and, beside it, 0.0005 (0.0002 to 0.001), in units \
             of the response"
        );
        assert!(super::law(Some(&law(0.0))).ends_with("whatever its size"));
        assert_eq!(super::law(None), "");
    }

    #[test]
    fn without_the_noise_there_is_no_chi_squared() {
        let mut answer = sample::identification();
        answer.fit = Fit { chi2: None, chi2_per_dof: None, adequate: None, ..answer.fit };
        let text = identification(&answer);
        assert!(!text.contains('χ'), "{text}");
        assert!(text.contains("cost"));
    }

    #[test]
    fn the_transfer_function_is_written_as_one() {
        let mut answer = sample::identification();
        assert!(identification(&answer).contains("G(s) = 10.01 / (s + 10.02)"));
        answer.transfer_function.poles = vec![[-10.02, 0.0], [-2.5, 31.5], [-2.5, -31.5]];
        assert!(identification(&answer).contains("-10.02, -2.5 ± 31.5j rad/s"));
        assert_eq!(polynomial(&[1.0, -2.0, 0.5], 3), "s^2 - 2 s + 0.5");
    }

    #[test]
    fn stages_are_those_of_the_chosen_order_and_the_rest_is_a_sum() {
        let mut answer = sample::identification();
        let text = identification(&answer);
        assert_eq!(words(&text, "refinement")[1..4], ["812.3", "37", "0.81"]);
        assert!(!text.contains("colony"), "{text}");
        assert!(text.contains("the other orders: 1057 evaluations, 1.90 s"), "{text}");
        answer.stages.push(sample::stage("extension", 17, 0.1, 608.7));
        let text = identification(&answer);
        assert_eq!(words(&text, "extension")[1..4], ["608.7", "17", "0.10"]);
        answer.order_choice = None;
        let text = identification(&answer);
        assert!(text.contains("colony (order 1)") && !text.contains("the other orders"), "{text}");
    }
}
