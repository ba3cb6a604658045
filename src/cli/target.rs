//! Files and folders that a command will write, looked at before it computes.

use std::fs::OpenOptions;
use std::path::Path;

use super::Failure;

fn failure(path: &Path, error: &std::io::Error) -> Failure {
    Failure::unwritten(path, error)
}

/// Whether a file can be written. What is in it stays until it is written, and a file that was not
/// there is not there afterwards.
///
/// # Errors
/// [`Failure::Input`] says why it cannot.
pub(super) fn file(path: &Path) -> Result<(), Failure> {
    let was_there = path.exists();
    let opened = OpenOptions::new().append(true).create(true).open(path);
    opened.map_err(|error| failure(path, &error))?;
    if !was_there {
        std::fs::remove_file(path).map_err(|error| failure(path, &error))?;
    }
    Ok(())
}

/// Whether a folder takes files; it is made where it is not there.
///
/// # Errors
/// [`Failure::Input`] says why it does not.
pub(super) fn folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| failure(path, &error))?;
    file(&path.join(".servoscope-writes-here"))
        .map_err(|_| Failure::Input(format!("{}: no file can be written here", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looking_at_a_file_changes_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("out.html");
        file(&path).unwrap();
        assert!(!path.exists());
        std::fs::write(&path, "kept").unwrap();
        file(&path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "kept");
    }

    #[test]
    fn what_cannot_be_written_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let nowhere = directory.path().join("no/out.html");
        assert!(file(&nowhere).unwrap_err().to_string().contains("no/out.html"));
        assert!(file(directory.path()).is_err());
        let taken = directory.path().join("taken");
        std::fs::write(&taken, "").unwrap();
        assert!(folder(&taken).is_err());
        folder(&directory.path().join("new/figures")).unwrap();
    }
}
