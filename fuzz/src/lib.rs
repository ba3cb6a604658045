//! What the fuzzers hold a reader of files to.

use std::sync::LazyLock;

use servoscope_core::measurement::formats::{Source, look, read, write_harmonic_csv};

/// The reader of workbooks catches the panics of the library that it uses; only those that nobody
/// catches are findings.
static CATCHABLE: LazyLock<()> = LazyLock::new(|| {
    // In place of the one of the fuzzer, which ends the process at any panic.
    std::panic::set_hook(Box::new(|panic| eprintln!("{panic}")));
});

/// Reads a file, alone and with something stated beside it, and looks at it as before an upload. It
/// is read or refused with a reason that has an end.
///
/// # Panics
/// Where it is not so.
pub fn is_read_or_refused(bytes: &[u8]) {
    LazyLock::force(&CATCHABLE);
    let given = Source { name: "given", bytes: b"# given with the upload\n# magnitude: 2\n" };
    let file = Source { name: "file", bytes };
    for sources in [&[file][..], &[file, given]] {
        look(sources);
        match read(sources) {
            Ok(measurement) => {
                let _ = write_harmonic_csv(&measurement, &mut std::io::sink());
            }
            Err(error) => {
                assert!(!error.reason.is_empty());
                let length = error.to_string().len();
                assert!(length < 10_000, "a reason of {length} bytes");
            }
        }
    }
}
