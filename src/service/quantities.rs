//! What the input and the response of a measurement are.

use serde::{Deserialize, Serialize};
use servoscope_core::measurement::{self, Loop, Metadata};

/// Name and unit of a quantity, empty where the upload does not say.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quantity {
    /// `current`, `force`, `velocity` …
    pub name: String,
    /// `A`, `N`, `rad/s` …
    pub unit: String,
}

impl From<&measurement::Quantity> for Quantity {
    fn from(measurement::Quantity { name, unit }: &measurement::Quantity) -> Self {
        Self { name: name.clone(), unit: unit.clone() }
    }
}

/// What input and response are, as it is stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quantities {
    /// The input.
    pub input: Quantity,
    /// The response.
    pub response: Quantity,
    /// `velocity`, `position` or `acceleration`.
    pub response_kind: String,
    /// `open` or `closed`, if the upload says.
    pub r#loop: Option<String>,
}

impl Quantities {
    pub(super) fn of(metadata: &Metadata) -> Self {
        let feedback = metadata.feedback.map(|feedback| match feedback {
            Loop::Open => "open".to_owned(),
            Loop::Closed => "closed".to_owned(),
        });
        Self {
            input: (&metadata.input).into(),
            response: (&metadata.response).into(),
            response_kind: format!("{:?}", metadata.response_kind).to_lowercase(),
            r#loop: feedback,
        }
    }
}
