//! A diagnosis as plain text for a terminal.

use servoscope_core::answers::{
    Diagnosis, Discrepancy, NoiseSource, Pattern, ResidualGroup, Verdict,
};

use super::causes::{self, tried, with_causes};
use super::columns::{Side, align_points, table};
use super::number::{digits, significant};
use super::text::{identification, parameters, section};
use super::validation;

/// Writes a diagnosis the way it is read: what it comes to and why, where the
/// simulation is wrong, how both were judged, and the model: with the causes,
/// where there are any, and of the base model its parameters alone, as all else
/// is the same.
pub fn diagnosis(answer: &Diagnosis) -> String {
    let Diagnosis { discrepancy, base, extended, .. } = answer;
    let mut sections = vec![section(verdict(answer.verdict), vec![discrepancy.sentence.clone()])];
    sections.extend(causes::sections(answer));
    if !answer.limitations.is_empty() {
        let lines = answer.limitations.iter().map(|text| format!("- {text}"));
        sections.push(section("Limitations", lines.collect()));
    }
    sections.extend(validation::of_second(answer));
    if !discrepancy.patterns.is_empty() {
        sections.push(section("Where it is wrong", patterns(&discrepancy.patterns)));
    }
    sections.push(section("What is left", left(discrepancy, base.noise)));
    sections.push(section("Is it noise?", tests(discrepancy)));
    if !answer.candidates.is_empty() {
        sections.push(section("What was tried", tried(&answer.candidates)));
    }
    match extended {
        None => sections.push(format!("The base model\n\n{}", identification(base))),
        Some(extended) => {
            let title = "Parameters of the base model, which takes the causes for its own";
            sections.push(section(title, parameters(&base.parameters)));
            let title = format!("The model {}", with_causes(&answer.causes));
            sections.push(format!("{title}\n\n{}", identification(extended)));
        }
    }
    sections.join("\n")
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Adequate => "ADEQUATE: nothing in the data speaks against the base model",
        Verdict::Explained => "EXPLAINED: with the named causes the model explains the data",
        Verdict::Improved => "IMPROVED: the named causes help, and something remains",
        Verdict::Unexplained => "UNEXPLAINED: the base model is wrong, and no cause is named",
    }
}

fn patterns(patterns: &[Pattern]) -> Vec<String> {
    let line = |(i, pattern): (usize, &Pattern)| {
        format!("{}. {:>3.0} %  {}", i + 1, 100.0 * pattern.share, pattern.sentence)
    };
    patterns.iter().enumerate().map(line).collect()
}

/// Residuals by magnitude and harmonic; by frequency and run, too, where it
/// matters where they are.
fn left(discrepancy: &Discrepancy, noise: NoiseSource) -> Vec<String> {
    let unit = if noise == NoiseSource::Estimated { "of the rest" } else { "sigmas" };
    let mut rows = vec![["by", "", "count", unit, "response", "relative"].map(str::to_owned)];
    let axes = [
        ("magnitude", &discrepancy.by_magnitude),
        ("harmonic", &discrepancy.by_harmonic),
        ("frequency, Hz", &discrepancy.by_frequency),
        ("run", &discrepancy.by_run),
    ];
    let shown = if discrepancy.noise_like { 2 } else { axes.len() };
    for (axis, groups) in axes.into_iter().take(shown) {
        for (i, group) in groups.iter().enumerate() {
            rows.push(row(if i == 0 { axis } else { "" }, group));
        }
    }
    let (left, right) = (Side::Left, Side::Right);
    align_points(rows.iter_mut().skip(1).map(|row| &mut row[3]));
    table([left, left, right, right, right, right], &rows)
}

fn row(axis: &str, group: &ResidualGroup) -> [String; 6] {
    let (from, to) = (significant(group.from, 3), significant(group.to, 3));
    [
        axis.to_owned(),
        if from == to { from } else { format!("{from} to {to}") },
        group.count.to_string(),
        digits(group.rms_sigmas, 3),
        digits(group.rms_response, 3),
        format!("{} %", digits(100.0 * group.relative, 2)),
    ]
}

fn tests(discrepancy: &Discrepancy) -> Vec<String> {
    let mut rows = vec![["test", "p", "", "meaning"].map(str::to_owned)];
    rows.extend(discrepancy.tests.iter().map(|test| {
        let p_value = match test.p_value {
            None => String::new(),
            Some(p) if p < 1e-6 => "< 1e-6".to_owned(),
            Some(p) => significant(p, 2),
        };
        let mark = match (test.p_value, test.passed) {
            (None, _) => "",
            (_, true) => "passed",
            (_, false) => "FAILED",
        };
        [test.name.clone(), p_value, mark.to_owned(), test.explanation.clone()]
    }));
    table([Side::Left, Side::Right, Side::Left, Side::Left], &rows)
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn the_verdict_and_its_sentence_come_first_and_the_base_model_last() {
        let answer = sample::diagnosis();
        let text = diagnosis(&answer);
        assert!(text.starts_with("UNEXPLAINED: the base model is wrong"), "{text}");
        let position = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
        assert!(position(&answer.discrepancy.sentence) < position("Where it is wrong"));
        assert!(position("Where it is wrong") < position("What is left"));
        assert!(position("Is it noise?") < position("Parameters"));
    }

    #[test]
    fn an_explained_diagnosis_goes_from_the_cause_to_the_model_with_it() {
        let answer = sample::explained();
        let text = diagnosis(&answer);
        assert!(text.starts_with("EXPLAINED: with the named causes"), "{text}");
        let order = [
            &answer.discrepancy.sentence,
            "\nCause\n",
            "\nWhat to measure next\n",
            "\nWhat the model explains\n",
            "\nWhere it is wrong\n",
            "\nWhat is left\n",
            "\nIs it noise?\n",
            "\nWhat was tried\n",
            "\nParameters of the base model",
            "\nThe model with static_friction\n\nADEQUATE",
            "\n  static_friction.fs_plus ",
            "\nservoscope 0.1.0",
        ];
        let position = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
        let positions = order.map(position);
        assert!(positions.is_sorted(), "{positions:?}: {text}");
        assert_eq!(text.matches("Stages").count(), 1, "{text}");
    }

    #[test]
    fn a_pattern_is_a_line_with_its_share_and_a_test_one_with_its_meaning() {
        let text = diagnosis(&sample::diagnosis());
        assert!(text.contains("1.  62 %  at the lowest magnitude (1 A), below 3 Hz, the third"));
        let line = |word: &str| text.lines().find(|line| line.trim().starts_with(word)).unwrap();
        assert!(line("size").contains("< 1e-6") && line("size").contains("FAILED"), "{text}");
        assert!(line("run").contains("not tested"), "{text}");
    }
}
