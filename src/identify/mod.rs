//! From a measurement to the parameters of the base model.

pub mod bee_colony;
pub mod network;

use crate::answers::{Identification, IdentifyOptions, InvalidOptions, Method, PlantRequest};
use crate::measurement::Measurement;
use crate::observer::Observer;

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
}

/// Fits the base model to a measurement.
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify(
    _measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Identification, IdentifyError> {
    request.options.validate()?;
    if observer.cancelled() {
        return Err(IdentifyError::Cancelled);
    }
    Err(IdentifyError::Unusable { reason: "not built yet".into() })
}
