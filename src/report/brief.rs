//! What an answer comes to, in the sentences that a person takes away. The page and the terminal
//! begin with them.

mod next;
mod verdict;

use servoscope_core::answers::{Answer, Cause, Diagnosis, Gain, Identification, ReadingDoubt};
use servoscope_core::effects::fit_words;

use super::number::{digits, significant};
use super::words::{list, sentence, typeset};

pub(super) use next::next;
pub(super) use verdict::{Judgement, Mark, is_candidate, judgement, of_diagnosis, of_fit, title};

/// What is wrong with the measurement, and what looks wrong with it.
pub(super) fn suspicions(answer: &Answer) -> Vec<String> {
    let faults = answer.diagnosis().map_or(&[][..], |answer| &answer.measurement);
    let faults = faults
        .iter()
        .map(|fault| format!("{} To correct it: {}.", sentence(&fault.sentence), fault.remedy));
    let rivals = answer.diagnosis().and_then(rival_faults);
    faults.chain(rivals).chain(answer.base().doubts.iter().map(doubt)).collect()
}

/// What may be wrong with the measurement in the place of a cause.
pub(super) fn rival_faults(answer: &Diagnosis) -> Option<String> {
    let found: Vec<&str> =
        answer.rival_faults.iter().map(|fault| fault.sentence.as_str()).collect();
    let found = found.join("; ");
    (!found.is_empty()).then(|| format!("The measurement may be wrong instead: {found}."))
}

/// What looks wrong with the measurement, and what to do.
pub(super) fn doubt(doubt: &ReadingDoubt) -> String {
    format!("{} To do: {}.", sentence(&doubt.sentence), doubt.remedy)
}

/// Units of the input and of the response.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Units<'a> {
    pub(super) input: &'a str,
    pub(super) response: &'a str,
}

impl<'a> Units<'a> {
    /// Those of a fit, as its parameters tell them.
    pub(super) fn of(fit: &'a Identification) -> Self {
        let unit = |id: &str| fit.parameters.get(id).map(|estimate| estimate.unit.as_str());
        let input = unit("fc_plus").or(unit("fc_mean")).unwrap_or_default();
        // `(mm/s)/V`: what is in front of the last stroke.
        let gain = unit("dc_gain").unwrap_or_default();
        Self { input, response: gain.rsplit_once('/').map_or("", |(response, _)| response) }
    }
}

/// What happens in the machine, as the library of effects tells it: without how it shows.
pub(super) fn meaning(cause: &Cause, units: Units<'_>) -> String {
    let meaning = cause.explanation.split(". How it shows").next().unwrap_or_default();
    sentence(&fit_words(meaning, units.input, units.response))
}

/// How a cause shows, where its explanation says it.
pub(super) fn signature(cause: &Cause, units: Units<'_>) -> Option<String> {
    let (_, signature) = cause.explanation.split_once(". How it shows: ")?;
    Some(sentence(&fit_words(signature, units.input, units.response)))
}

/// Residual before and after on held-out data: `0.361 % → 0.181 %`.
pub(super) fn before_and_after(gain: &Gain) -> String {
    let [before, after] = [gain.heldout_nrmse_before, gain.heldout_nrmse_after]
        .map(|error| format!("{}\u{a0}%", typeset(&digits(100.0 * error, 3))));
    format!("{before} → {after}")
}

/// Ratio of residuals above which another digit says nothing.
const LARGEST_RATIO: f64 = 1000.0;

/// By what the residual is divided, or multiplied, and whether that is beyond chance.
pub(super) fn factor(gain: &Gain) -> (String, bool) {
    let is_sure = gain.interval95[0] > 1.0;
    let text = match gain.ratio < 1.0 {
        true => format!("residual × {}", typeset(&significant(1.0 / gain.ratio, 3))),
        false if gain.ratio > LARGEST_RATIO => format!("residual ÷ more than {LARGEST_RATIO}"),
        false => format!("residual ÷ {}", typeset(&significant(gain.ratio, 3))),
    };
    (text, is_sure)
}

/// The interval of that factor.
pub(super) fn interval(gain: &Gain) -> String {
    let [low, high] = gain.interval95;
    let ends = if gain.ratio < 1.0 { [1.0 / high, 1.0 / low] } else { [low, high] };
    let [low, high] = ends.map(|end| typeset(&significant(end, 3)));
    format!("95\u{a0}% interval {low} to {high}")
}

/// What cannot be told from a cause, as a sentence; none where nothing is.
pub(super) fn equivalents(cause: &Cause) -> Option<String> {
    let others = list(cause.equivalents.iter().map(String::as_str), "or");
    (!others.is_empty()).then(|| format!("This measurement cannot tell it from {others}."))
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault, sample};

    use super::*;

    #[test]
    fn a_gain_is_a_factor_that_may_be_chance() {
        let gain = sample::gain();
        assert_eq!(factor(&gain), ("residual ÷ 3.15".into(), true));
        assert_eq!(before_and_after(&gain), "3.90\u{a0}% → 1.24\u{a0}%");
        let exact = Gain { ratio: 49_300.0, ..gain.clone() };
        assert_eq!(factor(&exact), ("residual ÷ more than 1000".into(), true));
        let worse = Gain { ratio: 0.9, interval95: [0.7, 1.1], ..gain };
        assert_eq!(factor(&worse), ("residual × 1.11".into(), false));
        assert_eq!(interval(&worse), "95\u{a0}% interval 0.909 to 1.43");
    }

    #[test]
    fn the_meaning_of_a_cause_and_how_it_shows_are_told_apart() {
        let mut cause = sample::explained().causes[0].clone();
        cause.explanation = "it takes more torque. How it shows: it sticks".into();
        let units = Units { input: "N", response: "m" };
        assert_eq!(meaning(&cause, units), "It takes more force.");
        assert_eq!(signature(&cause, units).as_deref(), Some("It sticks."));
        cause.explanation = "it sticks".into();
        assert_eq!(
            (meaning(&cause, units).as_str(), signature(&cause, units)),
            ("It sticks.", None)
        );
    }

    #[test]
    fn a_cause_beside_which_the_measurement_may_be_wrong_is_no_certainty() {
        let mut answer = sample::explained();
        let row = "line 9 is an outlier".to_owned();
        answer.rival_faults =
            vec![MeasurementFault { sentence: row, ..MeasurementFault::of(FaultKind::BadRows) }];
        let answer: Answer = answer.into();
        let Judgement { mark, text, .. } = judgement(&answer);
        assert!(mark == Mark::Open && text.contains("or the measurement is wrong"), "{text}");
        let said = suspicions(&answer);
        assert_eq!(said, ["The measurement may be wrong instead: line 9 is an outlier."]);
        assert!(next(&answer, Units::default())[0].starts_with("Repeat the doubtful part"));
    }
}
