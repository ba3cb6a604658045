//! The verdict: its word, and the one sentence that says what it means.

use servoscope_core::answers::{Answer, Cause, Diagnosis, Identification, NoiseSource, Verdict};

use crate::report::words::{a, joined, probability};

/// Confidence below which a cause is called a candidate.
const CANDIDATE: f64 = 0.5;

/// How good an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report) enum Mark {
    Good,
    Part,
    Bad,
    Open,
}

/// The verdict: its word, and the one sentence that says what it means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::report) struct Judgement {
    pub(in crate::report) word: &'static str,
    pub(in crate::report) mark: Mark,
    pub(in crate::report) text: String,
}

impl Judgement {
    /// The verdict in one line.
    pub(in crate::report) fn headline(&self) -> String {
        format!("{}: {}", self.word.to_uppercase(), self.text)
    }
}

/// The verdict of an answer.
pub(in crate::report) fn judgement(answer: &Answer) -> Judgement {
    match answer {
        Answer::Identification(answer) => of_fit(answer),
        Answer::Diagnosis(answer) => of_diagnosis(answer),
    }
}

/// The verdict of a fit.
pub(in crate::report) fn of_fit(answer: &Identification) -> Judgement {
    let is_noise = answer.fit.p_value.is_some_and(|p| p >= 0.01);
    let (word, mark, text) = match answer.fit.adequate {
        Some(true) => {
            ("Adequate", Mark::Good, "The model explains the measurement to within its noise.")
        }
        Some(false) if is_noise => {
            ("Not adequate", Mark::Bad, "The residual is larger than the simulated response.")
        }
        Some(false) => {
            ("Not adequate", Mark::Bad, "The residual of the model is larger than the noise.")
        }
        None if answer.noise == NoiseSource::Estimated => (
            "Adequacy unknown",
            Mark::Open,
            "The noise is not known, so this fit cannot be judged.",
        ),
        None => ("Not tested", Mark::Open, "There are too few data to test this model."),
    };
    Judgement { word, mark, text: text.to_owned() }
}

/// The verdict of a diagnosis.
pub(in crate::report) fn of_diagnosis(answer: &Diagnosis) -> Judgement {
    let causes = joined(answer.causes.iter().map(lacking).collect(), "and");
    let them = if answer.causes.len() > 1 { "them" } else { "it" };
    let (word, mark, text) = match answer.verdict {
        Verdict::Adequate if !answer.is_tested() => (
            "Not tested",
            Mark::Open,
            "There are too few data to test whether the simulation is wrong.".into(),
        ),
        Verdict::Adequate => {
            ("Adequate", Mark::Good, "This measurement shows no error in the simulation.".into())
        }
        Verdict::Explained => (
            "Explained",
            Mark::Good,
            format!(
                "The simulation lacks {causes}; with {them} added, it matches the measurement to \
                 within the noise."
            ),
        ),
        Verdict::Improved => ("Improved", Mark::Part, improved(&answer.causes)),
        Verdict::Unexplained => (
            "Unexplained",
            Mark::Bad,
            match answer.causes.is_empty() {
                true => {
                    "The simulation is wrong. No effect of the library improves it by more than \
                     chance."
                }
                // Of the verdict that a second measurement has lowered.
                false => {
                    "The simulation is wrong. With the effects that were named, it predicts the \
                     second measurement worse."
                }
            }
            .into(),
        ),
    };
    let (mark, text) = match answer.rival_faults.is_empty() {
        true => (mark, text),
        false => (
            Mark::Open,
            format!(
                "The simulation lacks {causes}, or the measurement is wrong: these data do not \
                 tell which."
            ),
        ),
    };
    let text = match (answer.measurement.len(), answer.verdict) {
        (0, _) => text,
        (1, Verdict::Adequate) => {
            "The measurement has a fault. With that corrected, it shows no error in the simulation."
                .into()
        }
        (1, _) => format!("The measurement has a fault, corrected here. {text}"),
        (count, _) => format!("The measurement has {count} faults, corrected here. {text}"),
    };
    Judgement { word, mark, text }
}

/// Whether a cause is named at so low a confidence that it has to be checked first.
pub(in crate::report) fn is_candidate(cause: &Cause) -> bool {
    cause.confidence < CANDIDATE
}

/// What a cause is called above its name.
pub(in crate::report) fn title(cause: &Cause) -> &'static str {
    if is_candidate(cause) { "Candidate" } else { "Cause" }
}

/// What an axis has that the simulation lacks: where it may as well be something else, that, too.
fn lacking(cause: &Cause) -> String {
    let others = cause.equivalents.iter().filter(|_| is_candidate(cause));
    joined(std::iter::once(&cause.effect).chain(others).map(|id| a(id)).collect(), "or")
}

/// The sentence of an answer with causes that do not explain everything.
fn improved(causes: &[Cause]) -> String {
    let (unsure, sure): (Vec<&Cause>, Vec<&Cause>) =
        causes.iter().partition(|cause| is_candidate(cause));
    let doubted = |cause: &&Cause| {
        format!("{} (confidence {})", a(&cause.effect), probability(cause.confidence))
    };
    let doubted = joined(unsure.iter().map(doubted).collect(), "and");
    let named = joined(sure.iter().map(|cause| a(&cause.effect)).collect(), "and");
    let lacks = match (sure.len(), unsure.len()) {
        (0, 1) => {
            return format!(
                "Something is missing from the simulation. The nearest candidate is {doubted}; \
                 check it on the machine before you rely on it."
            );
        }
        (0, _) => {
            return format!(
                "Something is missing from the simulation. The nearest candidates are {doubted}; \
                 check them on the machine before you rely on them."
            );
        }
        (_, 0) => named,
        _ => format!("{named}, and perhaps {doubted}"),
    };
    let them = if causes.len() > 1 { "them" } else { "it" };
    format!(
        "The simulation seems to lack {lacks}; with {them} added, it comes closer to the \
         measurement, but something remains unexplained."
    )
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    fn with_confidences(verdict: Verdict, confidences: &[f64]) -> Diagnosis {
        let mut answer = sample::explained();
        answer.verdict = verdict;
        let cause = answer.causes.remove(0);
        let each = confidences.iter().zip(["static_friction", "spring"]);
        answer.causes = each
            .map(|(confidence, id)| Cause {
                effect: id.into(),
                confidence: *confidence,
                ..cause.clone()
            })
            .collect();
        answer
    }

    #[test]
    fn what_has_a_low_confidence_is_a_candidate_and_nothing_that_the_simulation_lacks() {
        let said = |confidences: &[f64]| {
            of_diagnosis(&with_confidences(Verdict::Improved, confidences)).text
        };
        assert!(said(&[0.85]).starts_with("The simulation seems to lack static friction; with it"));
        assert!(said(&[0.19]).contains(
            "nearest candidate is static friction (confidence 19 %); check it on the machine"
        ));
        assert!(said(&[0.9, 0.17]).contains("and perhaps a spring (confidence 17 %); with them"));
        assert!(said(&[0.3, 0.2]).contains("nearest candidates are static friction"));
        let answer = with_confidences(Verdict::Explained, &[0.45]);
        let text = of_diagnosis(&answer).text;
        assert!(
            text.contains("lacks static friction, Stribeck friction or presliding; with it"),
            "{text}"
        );
        assert_eq!(title(&answer.causes[0]), "Candidate");
    }
}
