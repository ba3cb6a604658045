//! The request for an identification, and its errors.

use crate::answers::{IdentifyOptions, InvalidOptions, Method, PlantRequest};
use crate::effects::Library;
use crate::observer::Observer;

use super::methods::Methods;

use super::search_settings::SearchSettings;

/// Why an identification failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// An option has a value that cannot be used.
    #[error(transparent)]
    Options(#[from] InvalidOptions),
    /// The data cannot determine any model.
    #[error("the measurement cannot be fitted: {reason}")]
    Unusable {
        /// What the data lacks, and what would help.
        reason: String,
    },
}

/// A request to identify the base model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifyRequest {
    /// What is known of the plant beforehand; `None`: the actuator order is chosen from the data.
    pub plant: Option<PlantRequest>,
    /// The identification method.
    pub method: Method,
    /// Options of the identification.
    pub options: IdentifyOptions,
    /// The effects that a diagnosis tries.
    pub library: Library,
    /// The methods that may be named.
    pub methods: Methods,
    /// Settings of the search, which results do not report: only the benchmark changes them.
    pub search: SearchSettings,
}

/// A result, unless the observer cancelled while it was computed: it then lacks the simulations that
/// were left out, and may be wrong.
///
/// # Errors
/// Those of the result; [`IdentifyError::Cancelled`] once the observer cancels.
pub(crate) fn unless_cancelled<T, E: From<IdentifyError>>(
    observer: &dyn Observer,
    result: Result<T, E>,
) -> Result<T, E> {
    if observer.cancelled() { Err(IdentifyError::Cancelled.into()) } else { result }
}

/// The error for a fitted plant that has no periodic response.
pub(crate) fn no_response() -> IdentifyError {
    IdentifyError::Unusable {
        reason: "the fitted axis has no periodic response to this input".into(),
    }
}
