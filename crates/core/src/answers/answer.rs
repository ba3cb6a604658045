//! The answer to a job, whatever its kind.

use serde::Serialize;
use serde_path_to_error::Error;

use super::{Cause, Diagnosis, Discrepancy, Identification, Provenance, Verdict};

/// The answer to a job, whatever its kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Answer {
    /// To an `identify` job.
    Identification(Box<Identification>),
    /// To a `diagnose` job.
    Diagnosis(Box<Diagnosis>),
}

impl Answer {
    /// Reads the JSON form of either: a diagnosis has a `base` model, an
    /// identification is one.
    ///
    /// # Errors
    /// Where the text is not JSON, or a member of the answer, which is named, is
    /// missing or wrong.
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

    /// The model with the causes; `None` where none is named.
    pub fn extended(&self) -> Option<&Identification> {
        self.diagnosis().and_then(|diagnosis| diagnosis.extended.as_ref())
    }

    /// The model that explains the data best.
    pub fn model(&self) -> &Identification {
        self.extended().unwrap_or_else(|| self.base())
    }

    /// What the base model misses; empty where nobody asked.
    pub fn causes(&self) -> &[Cause] {
        self.diagnosis().map_or(&[], |diagnosis| &diagnosis.causes)
    }

    /// Where the base model is wrong; `None` where nobody asked.
    pub fn discrepancy(&self) -> Option<&Discrepancy> {
        self.diagnosis().map(|diagnosis| &diagnosis.discrepancy)
    }

    /// What a diagnosis comes to; `None` of an identification.
    pub fn verdict(&self) -> Option<Verdict> {
        self.diagnosis().map(|diagnosis| diagnosis.verdict)
    }

    /// The whole answer to a `diagnose` job; `None` of an identification.
    pub fn diagnosis(&self) -> Option<&Diagnosis> {
        match self {
            Self::Identification(_) => None,
            Self::Diagnosis(diagnosis) => Some(diagnosis),
        }
    }

    /// What is needed to compute it again.
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
    fn either_answer_is_known_by_its_json() {
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
    fn what_is_no_answer_is_refused_by_the_member_it_lacks() {
        let refused = |text: &str| Answer::from_json(text).unwrap_err().to_string();
        assert!(refused("{}").contains("`method`"), "{}", refused("{}"));
        let half = refused("{\"base\": {}}");
        assert!(half.starts_with("base: ") && half.contains("`method`"), "{half}");
        assert!(refused("magnitude,omega_rad_s").contains("line 1"));
    }
}
