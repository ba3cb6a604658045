//! Lines of a backup before they are packed, with a last line that is right: restored into an empty
//! store or refused. What is restored can be written again.
#![no_main]

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Mutex;

use flate2::Compression;
use flate2::write::GzEncoder;
use libfuzzer_sys::fuzz_target;
use servoscope::store::{Portable as _, Reader, Sqlite, Writer};
use sha2::{Digest as _, Sha256};
use tokio::runtime::Runtime;

/// A store that is empty, with what drives it.
static STORE: Mutex<Option<(Sqlite, Runtime)>> = Mutex::new(None);

fn folder() -> PathBuf {
    std::env::temp_dir().join(format!("servoscope-fuzz-{}", std::process::id()))
}

fn empty_store() -> (Sqlite, Runtime) {
    let _ = std::fs::remove_dir_all(folder());
    let runtime = Runtime::new().expect("threads can be started");
    let store = runtime.block_on(Sqlite::open(&folder())).expect("an empty folder");
    (store, runtime)
}

fn packed(lines: &[u8]) -> Vec<u8> {
    let rows = lines.split(|byte| *byte == b'\n').filter(|line| line.starts_with(b"[")).count();
    let sha256: String =
        Sha256::digest(lines).iter().map(|byte| format!("{byte:02x}")).collect();
    let mut packed = GzEncoder::new(Vec::new(), Compression::none());
    packed.write_all(lines).expect("a vector takes everything");
    write!(packed, "{{\"rows\":{rows},\"sha256\":\"{sha256}\"}}\n").expect("as before");
    packed.finish().expect("as before")
}

fuzz_target!(|lines: &[u8]| {
    let packed = packed(lines);
    let Ok(mut reader) = Reader::new(&packed[..]) else { return };
    let mut kept = STORE.lock().expect("a panic ends the process");
    let (store, runtime) = kept.get_or_insert_with(empty_store);
    match runtime.block_on(store.restore(&mut reader)) {
        Ok(()) => {
            let mut written = Vec::new();
            let mut writer = Writer::new(&mut written).expect("a vector takes everything");
            runtime.block_on(store.back_up(&mut writer)).expect("it was restored");
            writer.finish().expect("a vector takes everything");
            *kept = None;
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
