//! Why a command did not do what it was asked.

use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use crate::service::ServiceError;

/// Why a command did not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// The arguments or the input cannot be used.
    #[error("{0}")]
    Input(String),
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

impl Failure {
    pub(super) fn input(error: impl std::fmt::Display) -> Self {
        Self::Input(error.to_string())
    }

    pub(super) fn other(error: impl std::fmt::Display) -> Self {
        Self::Other(error.to_string())
    }

    /// A file that cannot be read.
    pub(super) fn unread(path: &Path, error: &std::io::Error) -> Self {
        Self::of_file(path, error, "there is no such file")
    }

    /// A file or folder that cannot be written.
    pub(super) fn unwritten(path: &Path, error: &std::io::Error) -> Self {
        Self::of_file(path, error, "the folder is not there; make it first")
    }

    fn of_file(path: &Path, error: &std::io::Error, absent: &str) -> Self {
        let path = path.display();
        Self::Input(match error.kind() {
            ErrorKind::NotFound => format!("{path}: {absent}"),
            ErrorKind::PermissionDenied => format!("{path}: no permission"),
            ErrorKind::IsADirectory => format!("{path}: this is a folder; name a file in it"),
            _ => format!("{path}: {error}"),
        })
    }

    pub(super) fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Input(_) => ExitCode::from(2),
            Failure::Other(_) => ExitCode::from(1),
        }
    }
}

impl From<ServiceError> for Failure {
    fn from(error: ServiceError) -> Self {
        match error {
            ServiceError::Upload(_) | ServiceError::Request { .. } => Self::input(error),
            _ => Self::other(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_there_is_told_without_numbers_of_the_system() {
        let path = Path::new("a.csv");
        let absent = std::io::Error::from_raw_os_error(2);
        assert_eq!(Failure::unread(path, &absent).to_string(), "a.csv: there is no such file");
        let said = Failure::unwritten(path, &absent).to_string();
        assert_eq!(said, "a.csv: the folder is not there; make it first");
        let full = std::io::Error::from(ErrorKind::StorageFull);
        assert!(Failure::unwritten(path, &full).to_string().starts_with("a.csv: "));
    }
}
