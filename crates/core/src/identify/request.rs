//! What is asked of an identification, and why there may be no answer.

use crate::answers::{IdentifyOptions, InvalidOptions, Method, PlantRequest};

use super::search_settings::SearchSettings;

/// Why an identification gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// An option no computation can use.
    #[error(transparent)]
    Options(#[from] InvalidOptions),
    /// The data cannot determine any model.
    #[error("the measurement cannot be fitted: {reason}")]
    Unusable {
        /// What is missing and what would help.
        reason: String,
    },
}

/// What is asked of an identification.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifyRequest {
    /// What is known of the plant; `None`: the order is chosen from the data.
    pub plant: Option<PlantRequest>,
    /// The method.
    pub method: Method,
    /// Its options.
    pub options: IdentifyOptions,
    /// How hard searches try. Answers do not tell it: all but measurements of what it is worth
    /// leave it as it is.
    pub search: SearchSettings,
}

/// The error of a fitted plant that does not move periodically.
pub(super) fn no_response() -> IdentifyError {
    IdentifyError::Unusable { reason: "the fitted plant has no periodic response".into() }
}
