//! Files of a folder, and uploading them.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::cli::Failure;
use crate::service::hexadecimal;

use super::remote::{self, Remote, Sent};
use super::request::{Request, segment};

/// A file that is a measurement of the server.
#[derive(Debug)]
pub(super) struct Stored {
    /// Its name.
    pub(super) file: String,
    /// The measurement.
    pub(super) measurement_id: String,
}

/// The files of a folder by their names; not those of folders in it, and not hidden ones.
///
/// # Errors
/// [`Failure::Input`] where the folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let wrong = |error| Failure::unread(folder, &error);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        if !name(&path).starts_with('.') && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Stores each file as a measurement and says which cannot be, and why. What was stored before is
/// not stored again.
///
/// # Errors
/// Where the server does not answer, or takes no more.
pub(super) async fn upload(
    remote: &Remote,
    files: &[PathBuf],
    given: &[(String, String)],
) -> Result<Vec<Stored>, Failure> {
    #[derive(Deserialize)]
    struct Measurement {
        id: String,
    }
    let bar = remote.bar(files.len() as u64);
    let mut stored = Vec::new();
    for path in files {
        bar.inc(1);
        let file = name(path);
        let not_read = |why: &dyn std::fmt::Display| {
            remote.say(&format!("{file}: not read: {why}"));
        };
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) => {
                not_read(&error);
                continue;
            }
        };
        match remote.json(&request(&file, bytes, given)).await {
            Ok(answer) => {
                let Measurement { id } = remote::read(answer)?;
                stored.push(Stored { file, measurement_id: id });
            }
            Err(Sent::Refused(refusal)) if refusal.is_of_file() => not_read(&refusal.detail),
            Err(error) => return Err(error.into()),
        }
    }
    bar.finish_and_clear();
    Ok(stored)
}

/// The request that stores a file. Its key is made of name, content and what is given beside it:
/// asked again, it is the same measurement.
fn request(file: &str, bytes: Vec<u8>, given: &[(String, String)]) -> Request {
    let mut hash = Sha256::new();
    let given_texts = given.iter().flat_map(|(key, value)| [key.as_bytes(), value.as_bytes()]);
    for part in [file.as_bytes(), &bytes].into_iter().chain(given_texts) {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    let key = format!("file-{}", hexadecimal(&hash.finalize()));
    let path = format!("/v1/measurements?name={}", segment(file));
    Request::post(path).file(file.to_owned(), bytes, given.to_vec()).keyed(key)
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_listed_by_name_without_hidden_ones_and_folders() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.csv", "a.csv", ".hidden"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        std::fs::create_dir(folder.path().join("older")).unwrap();
        let names: Vec<String> =
            files(folder.path()).unwrap().iter().map(|path| name(path)).collect();
        assert_eq!(names, ["a.csv", "b.csv"]);
        let nowhere = files(&folder.path().join("nowhere")).unwrap_err().to_string();
        assert!(nowhere.contains("nowhere"), "{nowhere}");
    }

    #[test]
    fn the_same_file_has_the_same_key_and_another_one_another() {
        let key = |file: &str, bytes: &[u8], given: &[(&str, &str)]| {
            let own = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
            let given: Vec<_> = given.iter().map(own).collect();
            format!("{:?}", request(file, bytes.to_vec(), &given))
        };
        assert_eq!(key("a.csv", b"x", &[]), key("a.csv", b"x", &[]));
        for other in [
            key("b.csv", b"x", &[]),
            key("a.csv", b"y", &[]),
            key("a.csv", b"x", &[("loop", "open")]),
        ] {
            assert_ne!(key("a.csv", b"x", &[]), other);
        }
    }
}
