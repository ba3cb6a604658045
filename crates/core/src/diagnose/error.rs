//! Errors of a diagnosis and of a validation.

use crate::identify::IdentifyError;

/// Why a diagnosis gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// The second measurement cannot be used.
    #[error("the second measurement: {0}")]
    Validation(#[from] ValidateError),
}

/// Why an answer cannot be validated on a measurement.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValidateError {
    /// The observer cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The second measurement has the same data as the one that is fitted.
    #[error(
        "it has the same data as the measurement that is fitted: an improvement on them proves \
         nothing; give another measurement of the same axis"
    )]
    SameData,
    /// The units of the measurement contradict those of the parameters.
    #[error(
        "its {quantity} is in {here}, the parameters are for {fitted}: give both measurements in \
         the same units"
    )]
    Units {
        /// `input` or `velocity`.
        quantity: &'static str,
        /// Unit in the measurement that was fitted.
        fitted: String,
        /// Unit in the other measurement.
        here: String,
    },
    /// The models cannot be simulated on the measurement.
    #[error("the models cannot be compared with it: {reason}")]
    Unusable {
        /// Why not.
        reason: String,
    },
}

impl From<IdentifyError> for ValidateError {
    fn from(error: IdentifyError) -> Self {
        match error {
            IdentifyError::Cancelled => Self::Cancelled,
            IdentifyError::Unusable { reason } => Self::Unusable { reason },
            IdentifyError::Options(invalid) => Self::Unusable { reason: invalid.to_string() },
        }
    }
}
