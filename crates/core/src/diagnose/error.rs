//! Why a diagnosis has no answer.

use crate::identify::IdentifyError;

use super::validation::ValidateError;

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
