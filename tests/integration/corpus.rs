//! The files that the fuzzers kept: each is read, or refused with a reason that has an end.

use std::path::{Path, PathBuf};

use servoscope_core::measurement::formats::{Source, look, read};

use crate::process::repository;

fn within(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn what_the_fuzzers_kept_is_read_or_refused() {
    let folders = within(&repository("fuzz/corpus"));
    let is_of_files = |folder: &&PathBuf| folder.to_string_lossy().contains("/files-");
    let folders: Vec<&PathBuf> = folders.iter().filter(is_of_files).collect();
    assert!(folders.len() > 10, "{folders:?}");
    for path in folders.into_iter().flat_map(|folder| within(folder)) {
        let bytes = std::fs::read(&path).unwrap();
        let given = Source { name: "given", bytes: b"# given with the upload\n# magnitude: 2\n" };
        let file = Source { name: "file", bytes: &bytes };
        for sources in [&[file][..], &[file, given]] {
            look(sources);
            if let Err(error) = read(sources) {
                assert!(!error.reason.is_empty(), "{}", path.display());
                assert!(error.to_string().len() < 10_000, "{}", path.display());
            }
        }
    }
}
