//! What the base model lacks, as a diagnosis names it.

use servoscope_core::answers::{Cause, Diagnosis, Gain, Identification};
use servoscope_core::effects::fit_words;

use super::brief::{Units, is_candidate, title};
use super::columns::{Side, align_points, table};
use super::number::significant;
use super::tables::{self, flags, in_digits};
use super::text::section;
use super::words;
use super::written::lines;

/// Sections on the causes, what to measure next and what the causes explain;
/// none where no cause is named.
pub(super) fn sections(answer: &Diagnosis) -> Vec<String> {
    let Diagnosis { causes, base, extended, next_experiment, .. } = answer;
    let mut sections = Vec::new();
    if !causes.is_empty() {
        let title = heading(causes);
        let lines =
            causes.iter().enumerate().flat_map(|(i, cause)| named(i + 1, cause, Units::of(base)));
        sections.push(section(title, lines.collect()));
    }
    if let Some(next) = next_experiment {
        sections.push(section("What to measure next", vec![next.reason.clone()]));
    }
    if let Some(extended) = extended {
        let title = "What the model explains";
        sections.push(section(title, explained(base, extended, &with_causes(causes))));
    }
    let gains = gains(answer);
    if !gains.is_empty() {
        sections.push(section("Improvement on held-out data", gained(&gains)));
    }
    sections
}

/// What causes are called together.
pub(super) fn heading(causes: &[Cause]) -> &'static str {
    match causes {
        [cause] => title(cause),
        causes if causes.iter().all(is_candidate) => "Candidates",
        _ => "Causes",
    }
}

/// Each model whose gain was measured, and that: with all causes, and with each
/// alone where there are several.
pub(super) fn gains(answer: &Diagnosis) -> Vec<(String, &Gain)> {
    let Diagnosis { causes, gain, .. } = answer;
    let all = gain.as_ref().map(|gain| (with_causes(causes), gain));
    // One cause alone is all causes together.
    let each = causes.iter().filter(|_| causes.len() > 1 || gain.is_none());
    let each = each.filter_map(|cause| {
        let name = format!("with {} alone", cause.effect);
        cause.gain.as_ref().map(|gain| (name, gain))
    });
    all.into_iter().chain(each).collect()
}

/// What was held out, each once.
pub(super) fn held_out<'a>(gains: &[(String, &'a Gain)]) -> Vec<&'a str> {
    let mut texts: Vec<&str> = gains.iter().map(|(_, gain)| gain.heldout.as_str()).collect();
    texts.dedup();
    texts
}

/// The error on data that neither a fit nor the choice of the causes has seen.
fn gained(gains: &[(String, &Gain)]) -> Vec<String> {
    let mut lines = lines(&tables::gains(gains));
    lines.extend(held_out(gains).into_iter().map(|text| format!("held out: {text}")));
    lines
}

/// What the model with the causes is called: `with stribeck and backlash`.
pub(super) fn with_causes(causes: &[Cause]) -> String {
    let names: Vec<&str> = causes.iter().map(|cause| cause.effect.as_str()).collect();
    format!("with {}", names.join(" and "))
}

fn named(number: usize, cause: &Cause, units: Units<'_>) -> Vec<String> {
    let Cause { effect, parameters, confidence, explanation, equivalents, margin, .. } = cause;
    let sure = format!("{} ({})", words::probability(*confidence), words::confidence(*confidence));
    let mut lines = vec![format!("{number}. {effect}, confidence {sure}")];
    let mut rows: Vec<[String; 4]> = parameters
        .iter()
        .map(|(name, estimate)| {
            let write = |number: f64| in_digits(estimate, number);
            let interval = match estimate.interval95 {
                Some([low, high]) => format!("95 % interval {} to {}", write(low), write(high)),
                None => String::new(),
            };
            let value = estimate.value.map_or("unknown".to_owned(), write);
            let note = [interval, flags(estimate).to_owned()];
            let note = note.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>();
            [name.clone(), value, estimate.unit.clone(), note.join(", ")]
        })
        .collect();
    align_points(rows.iter_mut().map(|row| &mut row[1]));
    let (left, right) = (Side::Left, Side::Right);
    let below = std::iter::once(fit_words(explanation, units.input, units.response))
        .chain(table(&[left, right, left, left], &rows));
    lines.extend(below.map(|line| format!("   {line}")));
    if let Some(margin) = without(*margin) {
        lines.push(format!("   {margin}"));
    }
    if !equivalents.is_empty() {
        let others = equivalents.join(" or ");
        lines.push(format!("   cannot be told from {others} by these data"));
    }
    lines
}

/// How far a cause stands out, if it does at all.
pub(super) fn without(margin: Option<f64>) -> Option<String> {
    let margin = margin.filter(|margin| *margin > 1.0)?;
    Some(format!(
        "without it and the effects most like it, the best model leaves {} times as much χ² beyond \
         the noise",
        significant(margin, 2)
    ))
}

/// The misfit of the base model above that with the causes.
fn explained(base: &Identification, extended: &Identification, with: &str) -> Vec<String> {
    let models = [("base model", &base.fit), (with, &extended.fit)];
    lines(&tables::misfit(models.into_iter()).arranged(&[0, 2, 3, 4, 1]))
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    fn line<'a>(text: &'a str, begin: &str) -> &'a str {
        let mut lines = text.lines().map(str::trim);
        lines.find(|line| line.starts_with(begin)).unwrap_or_else(|| panic!("{begin}: {text}"))
    }

    #[test]
    fn a_cause_has_confidence_meaning_parameters_and_what_it_cannot_be_told_from() {
        let text = sections(&sample::explained()).concat();
        assert_eq!(line(&text, "1."), "1. static_friction, confidence 93 % (very likely)");
        assert!(text.contains("   breakaway takes more torque than sliding"), "{text}");
        let words = |begin: &str| line(&text, begin).split_whitespace().collect::<Vec<_>>();
        assert_eq!(
            words("fs_plus")[1..],
            ["0.8014", "A", "95", "%", "interval", "0.7948", "to", "0.8079"]
        );
        assert_eq!(words("fs_minus")[1..4], ["unknown", "A", "not"]);
        assert_eq!(
            line(&text, "cannot"),
            "cannot be told from stribeck or presliding by these data"
        );
    }

    #[test]
    fn what_is_measured_in_newtons_is_told_of_a_force() {
        let mut answer = sample::explained();
        for (id, unit) in [("fc_plus", "N"), ("dc_gain", "(mm/s)/N")] {
            answer.base.parameters.get_mut(id).unwrap().unit = unit.into();
        }
        let text = sections(&answer).concat();
        assert!(text.contains("breakaway takes more force than sliding"), "{text}");
        assert!(!text.contains("torque"), "{text}");
    }

    #[test]
    fn the_next_experiment_is_given_by_its_reason_which_says_where() {
        let answer = sample::explained();
        let text = sections(&answer).concat();
        let reason = answer.next_experiment.unwrap().reason;
        assert!(text.contains(&format!("What to measure next\n  {reason}\n")), "{text}");
    }

    #[test]
    fn the_misfit_of_both_models_stands_in_one_table() {
        let text = sections(&sample::explained()).concat();
        assert_eq!(
            line(&text, "base model").split_whitespace().collect::<Vec<_>>(),
            ["base", "model", "2741", "842", "3.25", "3.81", "%"]
        );
        assert!(line(&text, "with static_friction").contains("812.3"), "{text}");
    }

    #[test]
    fn the_gain_says_before_after_and_what_was_held_out() {
        let mut answer = sample::explained();
        assert!(!sections(&answer).concat().contains("held out"));
        answer.gain = Some(sample::gain());
        answer.causes[0].gain = answer.gain.clone();
        let text = sections(&answer).concat();
        let words = |begin: &str| {
            let after = text.split("Improvement on held-out data").nth(1).unwrap();
            line(after, begin).split_whitespace().collect::<Vec<_>>()
        };
        assert_eq!(
            words("with static_friction")[2..],
            ["3.90", "%", "1.24", "%", "3.15", "2.71", "3.64", "3.31", "0.980"]
        );
        assert_eq!(line(&text, "held out:"), "held out: every third frequency");
        assert!(!text.contains("alone"), "one cause is all causes: {text}");
    }

    #[test]
    fn each_of_several_causes_has_its_own_gain_beside_that_of_all() {
        let mut answer = sample::explained();
        let second = Cause { effect: "spring".into(), ..answer.causes[0].clone() };
        answer.causes.push(second);
        answer.gain = Some(sample::gain());
        answer.causes[1].gain = answer.gain.clone();
        let names: Vec<String> = gains(&answer).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["with static_friction and spring", "with spring alone"]);
    }

    #[test]
    fn without_a_cause_there_is_nothing_to_say() {
        assert_eq!(sections(&sample::diagnosis()), Vec::<String>::new());
    }

    #[test]
    fn a_candidate_says_what_it_gains_and_why_it_is_no_cause() {
        let text = lines(&tables::tried(&sample::explained().candidates)).join("\n");
        assert_eq!(line(&text, "static_friction"), "static_friction  2131.9      632.2  named");
        assert!(line(&text, "stribeck").ends_with("static_friction explains the data better"));
        assert!(!text.contains("held out"), "{text}");
        let mut candidates = sample::explained().candidates;
        candidates[0].heldout_error = Some(0.0124);
        let with_error = lines(&tables::tried(&candidates)).join("\n");
        assert!(line(&with_error, "static_friction").contains("632.2    1.24 %  named"));
        let given_up = line(&text, "cogging").split_whitespace().collect::<Vec<_>>();
        assert_eq!(given_up[..3], ["cogging", "none", "the"]);
    }
}
