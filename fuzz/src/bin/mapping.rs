//! Mappings: settings in TOML, each alone taken or refused, and a table read with them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoscope_core::measurement::formats::{Given, Source, read};

const TABLE: &[u8] = b"Freq (Hz);Gain (dB);Phase (deg);Kohaerenz\n1,5;-6;-45;0,9\n2,5;-9;-60;0,8\n";
const RECORD: &[u8] = b"t;a;b\n0;0;0\n0.1;1;0\n0.2;0;1\n0.3;-1;0\n0.4;0;-1\n0.5;1;0\n0.6;0;1\n";

fuzz_target!(|text: &[u8]| {
    let Ok(text) = std::str::from_utf8(text) else { return };
    let Ok(table) = toml::from_str::<toml::Table>(text) else { return };
    let mut given = Given::default();
    for (key, value) in table {
        let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        if let Err(error) = given.set(&key, &value) {
            assert!(!error.reason.is_empty());
        }
    }
    let Some(stated) = given.text() else { return };
    let stated = Source { name: Given::NAME, bytes: stated.as_bytes() };
    for bytes in [TABLE, RECORD] {
        let _ = read(&[Source { name: "file", bytes }, stated]);
    }
});
