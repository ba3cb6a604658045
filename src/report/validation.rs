//! A validation as plain text for a terminal.

use servoscope_core::answers::{Diagnosis, Gain, ValidatedModel, Validation, Verdict};

use super::columns::{Side, align_points, table};
use super::number::{digits, significant};
use super::text::section;

/// Writes a validation the way it is read: what it comes to, the figures of both
/// models, what to mind, and of which data it speaks.
pub fn validation(answer: &Validation) -> String {
    let mut remarks = answer.remarks.iter();
    let first = remarks.next().cloned().into_iter().collect();
    let mut sections = vec![section(title(answer), first)];
    let title = format!("Residual of each model on the {}", answer.response_quantity);
    sections.push(section(&title, figures(answer)));
    let minded: Vec<String> = remarks.map(|text| format!("- {text}")).collect();
    if !minded.is_empty() {
        sections.push(section("Limitations", minded));
    }
    let provenance = &answer.provenance;
    sections.push(format!(
        "servoscope {}, fitted to data {:.12}, tried on data {:.12}\n",
        provenance.software_version,
        provenance.fitted_data_sha256,
        provenance.validation_data_sha256,
    ));
    sections.join("\n")
}

/// The same within a diagnosis, but for what its limitations say already; `None` where
/// there was no second measurement.
pub(super) fn of_second(answer: &Diagnosis) -> Option<String> {
    let validation = answer.validation.as_ref()?;
    let mut lines = figures(validation);
    let remarks = validation.remarks.iter().filter(|text| !answer.limitations.contains(text));
    lines.extend(remarks.map(|text| format!("- {text}")));
    let title =
        format!("Residual on the {} of the second measurement", validation.response_quantity);
    Some(section(&title, lines))
}

fn title(answer: &Validation) -> &'static str {
    match (&answer.gain, answer.models.extended.is_some()) {
        (_, false) => "TESTED: the base model on another measurement; no cause was named",
        (Some(Gain { interval95: [low, _], .. }), _) if *low > 1.0 => {
            "CONFIRMED: the causes help on another measurement, too"
        }
        (Some(Gain { interval95: [_, high], .. }), _) if *high < 1.0 => {
            "CONTRADICTED: on another measurement the model with the causes is worse than the base \
             model"
        }
        _ => "UNDECIDED: whether the causes help on another measurement cannot be told",
    }
}

fn figures(answer: &Validation) -> Vec<String> {
    let unit = match answer.response_unit.as_str() {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    let title = ["", "NRMSE", &format!("rms{unit}"), "χ² per value", "values"];
    let mut rows = vec![title.map(str::to_owned), row("base model", &answer.models.base)];
    if let Some(extended) = &answer.models.extended {
        let names: Vec<&str> = answer.causes.iter().map(|cause| cause.effect.as_str()).collect();
        rows.push(row(&format!("with {}", names.join(" and ")), extended));
    }
    for column in [1, 2, 3] {
        align_points(rows.iter_mut().skip(1).map(|row| &mut row[column]));
    }
    let (left, right) = (Side::Left, Side::Right);
    let mut lines = table(&[left, right, right, right, right], &rows);
    if let Some(gain) = &answer.gain {
        let [low, high] = gain.interval95.map(|end| digits(end, 3));
        let ratio = digits(gain.ratio, 3);
        lines.push(format!("residual ÷ {ratio}, 95 % interval {low} to {high}: {}", gain.heldout));
    }
    if let Some(verdict) = answer.verdict {
        lines.push(format!("verdict {}", name(verdict)));
    }
    lines
}

fn row(name: &str, model: &ValidatedModel) -> [String; 5] {
    [
        name.to_owned(),
        model.nrmse.map_or(String::new(), |nrmse| format!("{} %", digits(100.0 * nrmse, 3))),
        significant(model.rms, 3),
        model.chi2_per_dof.map_or(String::new(), |each| digits(each, 3)),
        model.components.to_string(),
    ]
}

fn name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Adequate => "ADEQUATE",
        Verdict::Explained => "EXPLAINED",
        Verdict::Improved => "IMPROVED",
        Verdict::Unexplained => "UNEXPLAINED",
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn what_it_comes_to_stands_first_and_both_models_in_one_table() {
        let text = validation(&sample::validation());
        assert!(text.starts_with("CONFIRMED: the causes help"), "{text}");
        let line = |begin: &str| {
            let mut lines = text.lines().map(str::trim);
            lines.find(|line| line.starts_with(begin)).unwrap_or_else(|| panic!("{begin}: {text}"))
        };
        let words = |begin: &str| line(begin).split_whitespace().collect::<Vec<_>>();
        assert_eq!(words("base model")[2..], ["2.00", "%", "0.02", "4.10", "96"]);
        assert_eq!(words("with static_friction")[2..], ["0.500", "%", "0.005", "1.02", "96"]);
        assert!(
            line("residual").starts_with("residual ÷ 4.00, 95 % interval 3.10 to 5.20: a second"),
            "{text}"
        );
        assert_eq!(line("verdict"), "verdict EXPLAINED");
        assert_eq!(line("- it"), "- it says little of the mean");
        assert!(
            text.contains("each model on the velocity") && text.contains("rms (rad/s)"),
            "{text}"
        );
    }

    #[test]
    fn in_a_diagnosis_nothing_is_said_twice() {
        let mut answer = sample::explained();
        assert_eq!(of_second(&answer), None);
        let validation = sample::validation();
        answer.limitations.push(validation.remarks[0].clone());
        answer.validation = Some(validation);
        let text = crate::report::diagnosis(&answer);
        assert!(text.contains("Residual on the velocity of the second measurement"), "{text}");
        assert_eq!(text.matches("static_friction helps here, too").count(), 1, "{text}");
        assert_eq!(text.matches("- it says little of the mean").count(), 1, "{text}");
    }

    #[test]
    fn its_title_follows_the_interval() {
        let mut answer = sample::validation();
        let mut with = |interval95| {
            answer.gain.as_mut().unwrap().interval95 = interval95;
            title(&answer)
        };
        assert!(with([0.9, 1.2]).starts_with("UNDECIDED"));
        assert!(with([0.4, 0.9]).starts_with("CONTRADICTED"));
        answer.gain = None;
        assert!(title(&answer).starts_with("UNDECIDED"));
        answer.models.extended = None;
        assert!(title(&answer).starts_with("TESTED"));
    }
}
