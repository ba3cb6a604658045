//! A diagnosis as plain text for a terminal.

use servoscope_core::answers::{Diagnosis, Discrepancy, NoiseSource, Pattern};

use super::brief;
use super::causes::{self, with_causes};
use super::columns::Side;
use super::measurement;
use super::tables::{self, Cell, Column, Table};
use super::text::{identification, section};
use super::validation;
use super::written::lines;

/// How to read the table of residuals.
const LEFT_SAYS: &str = "root mean squares of the residual of the base model: over the noise \
                         (sigmas; 1 is noise), in units of the response, and as a share of what was \
                         measured";

/// How to read the table of tests.
const TESTS_SAY: &str = "each test compares the residual of the base model with noise; p is the probability that noise \
     alone looks at least as bad";

/// Writes a diagnosis the way it is read: what it comes to and why, where the
/// simulation is wrong, how both were judged, and the model: with the causes,
/// where there are any, and of the base model its parameters alone, as all else
/// is the same.
pub fn diagnosis(answer: &Diagnosis) -> String {
    let Diagnosis { discrepancy, base, extended, .. } = answer;
    let linearity = answer.linearity.as_ref().map(|found| &found.sentence);
    let band = answer.valid_band.as_ref().map(|band| &band.sentence);
    let headline = [linearity, Some(&discrepancy.sentence), band].into_iter().flatten().cloned();
    let faults = answer.measurement.iter().map(|f| format!("the measurement: {}", f.sentence));
    let mut sections =
        vec![section(&brief::of_diagnosis(answer).headline(), faults.chain(headline).collect())];
    sections.extend(measurement::section_of(answer));
    sections.extend(causes::sections(answer));
    if !answer.limitations.is_empty() {
        let texts = answer.limitations.iter().map(|text| format!("- {text}"));
        sections.push(section("Limitations", texts.collect()));
    }
    sections.extend(validation::of_second(answer));
    if !discrepancy.patterns.is_empty() {
        sections.push(section("Where it is wrong", patterns(&discrepancy.patterns)));
    }
    sections
        .push(section("Residual, part by part", said(LEFT_SAYS, &left(discrepancy, base.noise))));
    sections.push(section("Is it noise?", said(TESTS_SAY, &tables::tests(&discrepancy.tests))));
    if !answer.candidates.is_empty() {
        sections.push(section(
            "What was tried",
            said(tables::TRIED_SAYS, &tables::tried(&answer.candidates)),
        ));
    }
    match extended {
        None => sections.push(format!("The base model\n\n{}", identification(base))),
        Some(extended) => {
            let title = "Parameters of the base model: they are biased by the causes that it lacks";
            sections.push(section(title, lines(&tables::parameters(&base.parameters, ""))));
            let title = format!("The model {}", with_causes(&answer.causes));
            sections.push(format!("{title}\n\n{}", identification(extended)));
        }
    }
    sections.join("\n")
}

/// A table below a sentence that says how to read it.
fn said(how: &str, table: &Table) -> Vec<String> {
    std::iter::once(how.to_owned()).chain(lines(table)).collect()
}

fn patterns(patterns: &[Pattern]) -> Vec<String> {
    let line = |(i, pattern): (usize, &Pattern)| {
        format!("{}. {:>3.0} %  {}", i + 1, 100.0 * pattern.share, pattern.sentence)
    };
    patterns.iter().enumerate().map(line).collect()
}

/// Residuals by magnitude and harmonic; by frequency and run, too, where it
/// matters where they are.
fn left(discrepancy: &Discrepancy, noise: NoiseSource) -> Table {
    let tables = tables::residuals(discrepancy, noise);
    let columns = &tables[0].1.columns;
    let by = Column { heading: "by", side: Side::Left, on_page: None };
    let columns = std::iter::once(by).chain(columns.iter().copied()).collect();
    let shown = if discrepancy.noise_like { 2 } else { tables.len() };
    let rows = tables.into_iter().take(shown).flat_map(|(axis, table)| {
        table.rows.into_iter().enumerate().map(move |(index, row)| {
            let axis = if index == 0 { axis } else { "" };
            std::iter::once(Cell::Words(axis.to_owned())).chain(row).collect()
        })
    });
    Table { columns, rows: rows.collect() }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn the_verdict_and_its_sentence_come_first_and_the_base_model_last() {
        let answer = sample::diagnosis();
        let text = diagnosis(&answer);
        assert!(text.starts_with("UNEXPLAINED: The simulation is wrong"), "{text}");
        let position = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
        assert!(position(&answer.discrepancy.sentence) < position("Where it is wrong"));
        assert!(position("Where it is wrong") < position("Residual, part by part"));
        assert!(position("Is it noise?") < position("Parameters"));
    }

    #[test]
    fn an_explained_diagnosis_goes_from_the_cause_to_the_model_with_it() {
        let answer = sample::explained();
        let text = diagnosis(&answer);
        assert!(text.starts_with("EXPLAINED: The simulation lacks"), "{text}");
        let order = [
            &answer.discrepancy.sentence,
            "\nCause\n",
            "\nWhat to measure next\n",
            "\nWhat the model explains\n",
            "\nWhere it is wrong\n",
            "\nResidual, part by part\n",
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
