//! The answer to a job of either kind.

use serde::Serialize;
use serde_path_to_error::Error;

use super::{Cause, Diagnosis, Discrepancy, Identification, Provenance, Verdict};

/// The answer to a job of either kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Answer {
    /// Answer to an `identify` job.
    Identification(Box<Identification>),
    /// Answer to a `diagnose` job.
    Diagnosis(Box<Diagnosis>),
}

impl Answer {
    /// Reads the JSON form of either kind. An object with a member `base` is a diagnosis, any other
    /// an identification.
    ///
    /// # Errors
    /// If the text is not JSON, or a member of the answer is missing or wrong; the error names it.
    pub fn from_json(text: &str) -> Result<Self, Error<serde_json::Error>> {
        let mut json = serde_json::Deserializer::from_str(text);
        let value: serde_json::Value = serde_path_to_error::deserialize(&mut json)?;
        match value.get("base") {
            Some(_) => serde_path_to_error::deserialize(value).map(Self::Diagnosis),
            None => serde_path_to_error::deserialize(value).map(Self::Identification),
        }
    }

    /// The base model.
    pub fn base(&self) -> &Identification {
        match self {
            Self::Identification(base) => base,
            Self::Diagnosis(diagnosis) => &diagnosis.base,
        }
    }

    /// The model with the causes; `None` if no cause is named.
    pub fn extended(&self) -> Option<&Identification> {
        self.diagnosis().and_then(|diagnosis| diagnosis.extended.as_ref())
    }

    /// The model that explains the data best.
    pub fn model(&self) -> &Identification {
        self.extended().unwrap_or_else(|| self.base())
    }

    /// The named causes, i.e. the effects that the base model lacks; empty for an identification.
    pub fn causes(&self) -> &[Cause] {
        self.diagnosis().map_or(&[], |diagnosis| &diagnosis.causes)
    }

    /// Where the base model is wrong; `None` for an identification.
    pub fn discrepancy(&self) -> Option<&Discrepancy> {
        self.diagnosis().map(|diagnosis| &diagnosis.discrepancy)
    }

    /// The verdict of a diagnosis; `None` for an identification.
    pub fn verdict(&self) -> Option<Verdict> {
        self.diagnosis().map(|diagnosis| diagnosis.verdict)
    }

    /// The whole answer to a `diagnose` job; `None` for an identification.
    pub fn diagnosis(&self) -> Option<&Diagnosis> {
        match self {
            Self::Identification(_) => None,
            Self::Diagnosis(diagnosis) => Some(diagnosis),
        }
    }

    /// What is needed to reproduce the answer.
    pub fn provenance(&self) -> &Provenance {
        match self {
            Self::Identification(answer) => &answer.provenance,
            Self::Diagnosis(answer) => &answer.provenance,
        }
    }
}

impl From<Identification> for Answer {
    fn from(answer: Identification) -> Self {
        Self::Identification(Box::new(answer))
    }
}

impl From<Diagnosis> for Answer {
    fn from(answer: Diagnosis) -> Self {
        Self::Diagnosis(Box::new(answer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::sample;

    #[test]
    fn json_of_either_kind_reads_back() {
        let diagnosis = Answer::Diagnosis(Box::new(sample::explained()));
        let identification = Answer::Identification(Box::new(sample::identification()));
        let text = serde_json::to_string(&sample::explained()).unwrap();
        assert_eq!(Answer::from_json(&text).unwrap(), diagnosis);
        let text = serde_json::to_string(&sample::identification()).unwrap();
        assert_eq!(Answer::from_json(&text).unwrap(), identification);
        assert_eq!((identification.verdict(), identification.extended()), (None, None));
        assert_eq!(diagnosis.verdict(), Some(Verdict::Explained));
    }

    #[test]
    fn json_that_is_no_answer_is_refused_with_the_missing_member() {
        let refused = |text: &str| Answer::from_json(text).unwrap_err().to_string();
        assert!(refused("{}").contains("`method`"), "{}", refused("{}"));
        let half = refused("{\"base\": {}}");
        assert!(half.starts_with("base: ") && half.contains("`method`"), "{half}");
        assert!(refused("magnitude,omega_rad_s").contains("line 1"));
    }
}
