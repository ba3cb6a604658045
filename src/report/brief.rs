//! What an answer comes to, in the sentences that a person takes away. The page and the terminal
//! begin with them.

use servoscope_core::answers::{
    Answer, Cause, Diagnosis, Gain, Identification, NoiseSource, ReadingDoubt, Verdict,
};
use servoscope_core::effects::fit_words;

use super::number::{digits, significant};
use super::words::{a, joined, list, quantity, sentence, typeset, without_ids};

/// How good an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Good,
    Part,
    Bad,
    Open,
}

/// The verdict: its word, and the one sentence that says what it means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Judgement {
    pub(super) word: &'static str,
    pub(super) mark: Mark,
    pub(super) text: String,
}

impl Judgement {
    /// The verdict in one line.
    pub(super) fn headline(&self) -> String {
        format!("{}: {}", self.word.to_uppercase(), self.text)
    }
}

/// The verdict of an answer.
pub(super) fn judgement(answer: &Answer) -> Judgement {
    match answer {
        Answer::Identification(answer) => of_fit(answer),
        Answer::Diagnosis(answer) => of_diagnosis(answer),
    }
}

/// The verdict of a fit.
pub(super) fn of_fit(answer: &Identification) -> Judgement {
    let is_noise = answer.fit.p_value.is_some_and(|p| p >= 0.01);
    let (word, mark, text) = match answer.fit.adequate {
        Some(true) => {
            ("Adequate", Mark::Good, "The model explains the measurement to within its noise.")
        }
        Some(false) if is_noise => (
            "Not adequate",
            Mark::Bad,
            "The model leaves more of the measurement than it explains.",
        ),
        Some(false) => {
            ("Not adequate", Mark::Bad, "The model leaves more of the measurement than noise.")
        }
        None if answer.noise == NoiseSource::Estimated => (
            "Adequacy unknown",
            Mark::Open,
            "Whether the model explains the measurement cannot be said: its noise is not known.",
        ),
        None => (
            "Adequacy unknown",
            Mark::Open,
            "Whether the model explains the measurement cannot be said: it has no more data than \
             the model has parameters.",
        ),
    };
    Judgement { word, mark, text: text.to_owned() }
}

/// The verdict of a diagnosis.
pub(super) fn of_diagnosis(answer: &Diagnosis) -> Judgement {
    let causes = joined(answer.causes.iter().map(|cause| a(&cause.effect)).collect(), "and");
    let them = if answer.causes.len() > 1 { "them" } else { "it" };
    let (word, mark, text) = match answer.verdict {
        Verdict::Adequate => (
            "Adequate",
            Mark::Good,
            "Nothing in this measurement speaks against the simulation.".into(),
        ),
        Verdict::Explained => (
            "Explained",
            Mark::Good,
            format!(
                "The simulation lacks {causes}; with {them} added, it matches the measurement to \
                 within the noise."
            ),
        ),
        Verdict::Improved => (
            "Improved",
            Mark::Part,
            format!(
                "The simulation seems to lack {causes}; with {them} added, it comes closer to the \
                 measurement, but something remains unexplained."
            ),
        ),
        Verdict::Unexplained => (
            "Unexplained",
            Mark::Bad,
            "The simulation is wrong, and no known effect is the cause.".into(),
        ),
    };
    let (mark, text) = match answer.rival_faults.is_empty() {
        true => (mark, text),
        false => (
            Mark::Open,
            format!(
                "The simulation lacks {causes}, or the measurement is wrong: this data does not tell \
                 which."
            ),
        ),
    };
    let text = match (answer.measurement.len(), answer.verdict) {
        (0, _) => text,
        (1, Verdict::Adequate) => {
            "The measurement has a fault; with that corrected, nothing speaks against the simulation."
                .into()
        }
        (1, _) => format!("The measurement has a fault, corrected here. {text}"),
        (count, _) => format!("The measurement has {count} faults, corrected here. {text}"),
    };
    Judgement { word, mark, text }
}

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

/// Units of the command and of the response.
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

/// Error before and after on data held out: `0.361 % → 0.181 %`.
pub(super) fn before_and_after(gain: &Gain) -> String {
    let [before, after] = [gain.heldout_nrmse_before, gain.heldout_nrmse_after]
        .map(|error| format!("{}\u{a0}%", typeset(&digits(100.0 * error, 3))));
    format!("{before} → {after}")
}

/// By how much a gain is one, in words, and whether it is beyond chance.
pub(super) fn factor(gain: &Gain) -> (String, bool) {
    let is_sure = gain.interval95[0] > 1.0;
    let text = match gain.ratio < 1.0 {
        true => format!("{} times the error", typeset(&significant(1.0 / gain.ratio, 3))),
        false => format!("{} times less error", typeset(&significant(gain.ratio, 3))),
    };
    (text, is_sure)
}

/// The interval of a gain.
pub(super) fn interval(gain: &Gain) -> String {
    let [low, high] = gain.interval95.map(|end| typeset(&significant(end, 3)));
    format!("95\u{a0}%: {low} to {high}")
}

/// What to do with an answer, most important first.
pub(super) fn next(answer: &Answer, units: Units<'_>) -> Vec<String> {
    let Answer::Diagnosis(answer) = answer else {
        return match answer.base().fit.adequate {
            Some(false) => vec![
                "Ask for a diagnosis: it says where the model is wrong, and why. Until then its \
                 parameters absorb what is missing."
                    .into(),
            ],
            Some(true) => vec!["Use the model at the magnitudes and frequencies measured.".into()],
            None if answer.base().noise == NoiseSource::Estimated => vec![
                "Give the noise (a column std, repeats or --noise-std), so that the model can be \
                 judged."
                    .into(),
            ],
            None => vec![
                "Measure more magnitudes, frequencies or harmonics, so that the model can be judged."
                    .into(),
            ],
        };
    };
    let band = answer.valid_band.as_ref().map(|band| sentence(&band.sentence));
    let ids = answer.candidates.iter().map(|candidate| candidate.effect.as_str());
    let experiment = match (&answer.next_experiment, answer.verdict) {
        _ if !answer.rival_faults.is_empty() => {
            "Repeat that part of the measurement: a deviation that appears again comes from the machine.".into()
        }
        (Some(next), _) => {
            let magnitude = quantity(next.magnitude, 4, units.input);
            let hertz = quantity(next.omega_rad_s / std::f64::consts::TAU, 4, "Hz");
            let reason = sentence(&without_ids(&next.reason, ids));
            // The reason may begin with where to measure.
            match reason.contains("Hz") {
                true => reason,
                false => format!("Measure at magnitude {magnitude} and {hertz}. {reason}"),
            }
        }
        (None, Verdict::Adequate) => String::new(),
        (None, Verdict::Explained) => {
            "Add the cause to your model. No other effect fits nearly as well, so no further \
             experiment is needed."
                .into()
        }
        (None, Verdict::Improved) => {
            "Check the cause on the machine: something else is wrong as well, and it may look like \
             this cause."
                .into()
        }
        (None, Verdict::Unexplained) => {
            "Measure more magnitudes, frequencies and harmonics where the model is wrong: no single \
             experiment separates the effects that were tried."
                .into()
        }
    };
    [experiment].into_iter().chain(band).filter(|text| !text.is_empty()).collect()
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
        assert_eq!(factor(&gain), ("3.15 times less error".into(), true));
        assert_eq!(before_and_after(&gain), "3.90\u{a0}% → 1.24\u{a0}%");
        let worse = Gain { ratio: 0.9, interval95: [0.7, 1.1], ..gain };
        assert_eq!(factor(&worse), ("1.11 times the error".into(), false));
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
        let row = "line 9 does not belong to the rest".to_owned();
        answer.rival_faults =
            vec![MeasurementFault { sentence: row, ..MeasurementFault::of(FaultKind::BadRows) }];
        let answer: Answer = answer.into();
        let Judgement { mark, text, .. } = judgement(&answer);
        assert!(mark == Mark::Open && text.contains("or the measurement is wrong"), "{text}");
        let said = suspicions(&answer);
        assert_eq!(
            said,
            ["The measurement may be wrong instead: line 9 does not belong to the rest."]
        );
        assert!(
            next(&answer, Units::default())[0].starts_with("Repeat that part of the measurement")
        );
    }

    #[test]
    fn an_answer_says_what_to_do_with_it() {
        let units = Units::default();
        let answer: Answer = sample::diagnosis().into();
        let said = next(&answer, units).join(" ");
        assert!(said.starts_with("Measure more") && said.contains("from 0.1 to 8 Hz"), "{said}");
        let mut fit = sample::identification();
        fit.fit.adequate = Some(false);
        assert!(next(&fit.into(), units)[0].starts_with("Ask for a diagnosis"));
    }
}
