//! The parts of a workbook, put into an archive that is whole: each part begins with a line of its
//! name after a null byte.
#![no_main]

use std::io::{Cursor, Write as _};

use libfuzzer_sys::fuzz_target;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

fuzz_target!(|parts: &[u8]| {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for part in parts.split(|byte| *byte == 0) {
        let mut halves = part.splitn(2, |byte| *byte == b'\n');
        let name = String::from_utf8_lossy(halves.next().unwrap_or_default());
        // Two parts of one name are none.
        if archive.start_file(name.into_owned(), stored).is_ok() {
            let text = halves.next().unwrap_or_default();
            archive.write_all(text).expect("a vector takes everything");
        }
    }
    if let Ok(archive) = archive.finish() {
        servoscope_fuzz::is_read_or_refused(archive.get_ref());
    }
});
