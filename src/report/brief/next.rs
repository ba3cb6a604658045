//! What to do with an answer.

use servoscope_core::answers::{Answer, NoiseSource, Verdict};

use super::Units;
use crate::report::words::{list, quantity, sentence, without_ids};

/// What to do with an answer, most important first.
pub(in crate::report) fn next(answer: &Answer, units: Units<'_>) -> Vec<String> {
    let Answer::Diagnosis(answer) = answer else {
        return match answer.base().fit.adequate {
            Some(false) => vec![
                "Run a diagnosis (`servoscope diagnose FILE`): it says where the model is wrong, \
                 and why. Until then do not trust these parameters: they are biased by what the \
                 model lacks."
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
    let band = answer.valid_band.as_ref().filter(|_| answer.is_tested());
    let band = band.map(|band| sentence(&band.sentence));
    let ids = answer.candidates.iter().map(|candidate| candidate.effect.as_str());
    let named = list(answer.causes.iter().map(|cause| cause.effect.as_str()), "and");
    let them = if answer.causes.len() > 1 { "them" } else { "it" };
    let experiment = match (&answer.next_experiment, answer.verdict) {
        _ if !answer.rival_faults.is_empty() => {
            "Repeat the doubtful part of the measurement. A deviation that appears again comes from \
             the machine; one that does not came from the measurement."
                .into()
        }
        (Some(next), _) => {
            let magnitude = quantity(next.magnitude, 4, units.input);
            let hertz = quantity(next.omega_rad_s / std::f64::consts::TAU, 4, "Hz");
            let reason = sentence(&without_ids(&next.reason, ids));
            // The reason may begin with where to measure.
            match reason.starts_with("Measure at") {
                true => reason,
                false => format!("Measure at magnitude {magnitude} and {hertz}. {reason}"),
            }
        }
        (None, Verdict::Adequate) if !answer.is_tested() => {
            "Measure at more magnitudes, frequencies or harmonics, so that the simulation can be \
             tested."
                .into()
        }
        (None, Verdict::Adequate) => String::new(),
        (None, Verdict::Explained) => format!(
            "Add {named} to your model. No other effect of the library explains the data nearly as \
             well, so no further experiment is asked for."
        ),
        (None, Verdict::Improved) => format!(
            "Check {named} on the machine. Something else is wrong, too, and may have been \
             mistaken for {them}."
        ),
        (None, Verdict::Unexplained) => {
            "Measure more magnitudes, frequencies and harmonics where the model is wrong: no single \
             experiment separates the effects that were tried."
                .into()
        }
    };
    [experiment].into_iter().chain(band).filter(|text| !text.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::super::{Judgement, Mark, of_diagnosis};
    use super::*;

    #[test]
    fn an_answer_says_what_to_do_with_it() {
        let units = Units::default();
        let answer: Answer = sample::diagnosis().into();
        let said = next(&answer, units).join(" ");
        assert!(said.starts_with("Measure more") && said.contains("from 0.1 to 8 Hz"), "{said}");
        let mut fit = sample::identification();
        fit.fit.adequate = Some(false);
        assert!(next(&fit.into(), units)[0].starts_with("Run a diagnosis"));
    }

    #[test]
    fn what_could_not_be_tested_is_not_called_adequate_and_has_no_band() {
        let mut answer = sample::diagnosis();
        answer.verdict = Verdict::Adequate;
        assert_eq!(of_diagnosis(&answer).word, "Adequate");
        for test in &mut answer.discrepancy.tests {
            test.p_value = None;
        }
        let Judgement { word, mark, .. } = of_diagnosis(&answer);
        assert_eq!((word, mark), ("Not tested", Mark::Open));
        let said = next(&answer.into(), Units::default());
        assert!(said.len() == 1 && said[0].starts_with("Measure at more"), "{said:?}");
    }
}
