//! Why a backup could not be made or restored.

use std::io::{self, ErrorKind};

use super::super::StoreError;

/// Why a backup could not be made or restored.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    /// The store could not be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The file could not be read or written.
    #[error("the file of the backup: {0}")]
    File(io::Error),
    /// The file is another one.
    #[error("this is not a backup of servoscope")]
    Foreign,
    /// The file is not as it was written.
    #[error("the backup is cut off or damaged ({0}): take another copy of it")]
    Damaged(String),
    /// The file has something that this version does not know.
    #[error("a newer version of servoscope made this backup ({0}): restore it with that version")]
    Newer(String),
    /// The store to be filled has something already.
    #[error("a backup is restored into an empty store only, and this one has rows in {0}")]
    NotEmpty(String),
}

impl From<sqlx::Error> for BackupError {
    fn from(error: sqlx::Error) -> Self {
        Self::Store(error.into())
    }
}

impl BackupError {
    /// Of an error in reading a packed file.
    pub(super) fn reading(error: io::Error) -> Self {
        match error.kind() {
            ErrorKind::UnexpectedEof => Self::Damaged("it ends too early".into()),
            ErrorKind::InvalidInput | ErrorKind::InvalidData => Self::Damaged(error.to_string()),
            _ => Self::File(error),
        }
    }
}
