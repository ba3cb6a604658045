//! Measured data, which the repository does not carry, and reference responses, which it does.

use std::io::Write;
use std::path::{Path, PathBuf};

/// The file or folder `path` of `../shared`, where measured data is `data/…`.
///
/// `SERVO_DATA_DIR` says where the measured data is instead. Where the file is
/// absent this says so and answers `None`: the test is skipped. With
/// `SERVO_REQUIRE_DATA` set that is a failure.
pub fn shared(path: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data_dir = std::env::var_os("SERVO_DATA_DIR");
    let file = match (path.strip_prefix("data"), data_dir) {
        (Some(inside), Some(folder)) => root.join(folder).join(inside.trim_start_matches('/')),
        _ => root.join("../shared").join(path),
    };
    if file.exists() {
        return Some(file);
    }
    let absent = format!("{} is absent", file.display());
    assert!(std::env::var_os("SERVO_REQUIRE_DATA").is_none(), "{absent}");
    skipped(&absent);
    None
}

/// A file of the contract's reference responses, `tests/reference/…`.
pub fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(name)
}

/// Says why a test is skipped, past the capture of a passing test's output.
pub fn skipped(reason: &str) {
    // Where standard error is closed nobody reads it.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}
