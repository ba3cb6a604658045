//! What stands out of a result: kept beside it, so that a table of many need not read them all.

use serde::Deserialize;

/// What is kept in the place of the verdict `adequate` where the data were too few for any test of the
/// base model.
pub const NOT_TESTED: &str = "not_tested";

/// What stands out of a result.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Gist {
    /// The verdict of a diagnosis, or [`NOT_TESTED`].
    pub(super) verdict: Option<String>,
    /// The strongest cause that it names.
    pub(super) cause: Option<String>,
    /// The confidence in it.
    pub(super) confidence: Option<f64>,
}

#[derive(Deserialize)]
struct Outline {
    verdict: Option<String>,
    #[serde(default)]
    causes: Vec<Named>,
    #[serde(default)]
    discrepancy: Tests,
}

#[derive(Deserialize, Default)]
struct Tests {
    #[serde(default)]
    tests: Vec<Test>,
}

#[derive(Deserialize)]
struct Test {
    p_value: Option<f64>,
}

impl Tests {
    /// Whether there are tests and none could be made.
    fn are_all_missing(&self) -> bool {
        !self.tests.is_empty() && self.tests.iter().all(|test| test.p_value.is_none())
    }
}

#[derive(Deserialize)]
struct Named {
    effect: String,
    confidence: f64,
}

impl Gist {
    /// Of the JSON of a result; of one that has nothing of the kind, nothing.
    pub(super) fn of(result: &str) -> Self {
        let Ok(Outline { verdict, causes, discrepancy }) = serde_json::from_str(result) else {
            return Self::default();
        };
        let verdict = verdict.map(|verdict| match verdict.as_str() {
            "adequate" if discrepancy.are_all_missing() => NOT_TESTED.to_owned(),
            _ => verdict,
        });
        let first = causes.into_iter().next();
        let (cause, confidence) = first.map(|named| (named.effect, named.confidence)).unzip();
        Self { verdict, cause, confidence }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{Answer, Diagnosis, Verdict, sample};

    use super::*;

    #[test]
    fn a_diagnosis_says_its_verdict_and_its_first_cause_and_an_identification_nothing() {
        let diagnosis = sample::explained();
        let text = serde_json::to_string(&Answer::from(diagnosis.clone())).unwrap();
        let gist = Gist::of(&text);
        assert_eq!(gist.verdict.as_deref(), Some(diagnosis.verdict.name()));
        assert_eq!(gist.cause, Some(diagnosis.causes[0].effect.clone()));
        assert_eq!(gist.confidence, Some(diagnosis.causes[0].confidence));
        let text = serde_json::to_string(&sample::identification()).unwrap();
        assert_eq!(Gist::of(&text), Gist::default());
        assert_eq!(Gist::of("what another version wrote"), Gist::default());
    }

    #[test]
    fn a_verdict_without_any_test_says_so() {
        let mut diagnosis = sample::diagnosis();
        let verdict = |diagnosis: &Diagnosis| {
            Gist::of(&serde_json::to_string(&Answer::from(diagnosis.clone())).unwrap()).verdict
        };
        diagnosis.verdict = Verdict::Adequate;
        assert_eq!(verdict(&diagnosis).as_deref(), Some("adequate"));
        for test in &mut diagnosis.discrepancy.tests {
            test.p_value = None;
        }
        assert!(!diagnosis.is_tested());
        assert_eq!(verdict(&diagnosis).as_deref(), Some(NOT_TESTED));
        diagnosis.verdict = Verdict::Unexplained;
        assert_eq!(verdict(&diagnosis).as_deref(), Some("unexplained"));
        diagnosis.verdict = Verdict::Adequate;
        diagnosis.discrepancy.tests.clear();
        assert_eq!(verdict(&diagnosis).as_deref(), Some("adequate"));
    }
}
