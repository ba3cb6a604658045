//! What stands out of a result: kept beside it, so that a table of many need not read them all.

use serde::Deserialize;

/// What stands out of a result.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Gist {
    /// The verdict of a diagnosis.
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
}

#[derive(Deserialize)]
struct Named {
    effect: String,
    confidence: f64,
}

impl Gist {
    /// Of the JSON of a result; of one that has nothing of the kind, nothing.
    pub(super) fn of(result: &str) -> Self {
        let Ok(Outline { verdict, causes }) = serde_json::from_str(result) else {
            return Self::default();
        };
        let first = causes.into_iter().next();
        let (cause, confidence) = first.map(|named| (named.effect, named.confidence)).unzip();
        Self { verdict, cause, confidence }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{Answer, sample};

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
}
