//! Why a diagnosis, or a validation, has no answer.

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

/// Why an answer cannot be tried on a measurement.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValidateError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// It is the one that was fitted.
    #[error(
        "it has the same data as the measurement that is fitted: what is gained on them proves \
         nothing; give another measurement of the same axis"
    )]
    SameData,
    /// Its units contradict those of the parameters.
    #[error(
        "its {quantity} is in {here}, the parameters are for {fitted}: give both measurements in \
         the same units"
    )]
    Units {
        /// `input` or `velocity`.
        quantity: &'static str,
        /// Unit that was fitted in.
        fitted: String,
        /// Unit of the other measurement.
        here: String,
    },
    /// No model can be simulated on it.
    #[error("the models cannot be tried on it: {reason}")]
    Unusable {
        /// What is missing.
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
