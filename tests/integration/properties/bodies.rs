//! Whatever is sent as JSON, or stands in a file of settings or a mapping: it is taken or refused,
//! and the process that reads it goes on, with memory that a body of its size warrants.

use proptest::prelude::*;
use proptest::sample::{Index, select};
use serde_json::Value;
use servoscope::config::Settings;

use super::drawn;
use crate::process::{Server, servoscope};

/// Most memory that the server may ever have had, KiB.
const MOST_KIB: u64 = 1 << 20;

/// Values at the edges, in place of a number.
const NUMBERS: [&str; 9] =
    ["1e400", "-1e308", "1e-320", "99999999999999999999", "NaN", "null", "-0", "\"\"", "[]"];

#[derive(Debug, Clone)]
enum Change {
    Cut(Index),
    Flip(Index, u8),
    Number(Index, &'static str),
    Nest(Index, &'static str, u16),
    Anything(Vec<u8>),
}

fn changes() -> impl Strategy<Value = Change> {
    let openings = ["[", "{\"a\":", "\"", "a = [", "[a.", "\u{0}"];
    prop_oneof![
        any::<Index>().prop_map(Change::Cut),
        (any::<Index>(), 1..=255_u8).prop_map(|(at, bits)| Change::Flip(at, bits)),
        (any::<Index>(), select(&NUMBERS[..])).prop_map(|(at, new)| Change::Number(at, new)),
        (any::<Index>(), select(openings.to_vec()), 1..20_000_u16)
            .prop_map(|(at, opening, count)| Change::Nest(at, opening, count)),
        proptest::collection::vec(any::<u8>(), 0..300).prop_map(Change::Anything),
    ]
}

fn changed(text: &str, change: &Change) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    match change {
        Change::Cut(at) => bytes.truncate(at.index(text.len())),
        Change::Flip(at, bits) => bytes[at.index(text.len())] ^= bits,
        Change::Nest(at, opening, count) => {
            let at = at.index(text.len());
            bytes.splice(at..at, opening.repeat((*count).into()).into_bytes());
        }
        Change::Number(at, new) => {
            let from = at.index(text.len());
            let digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(begin) = bytes[from..].iter().position(digit) {
                let begin = from + begin;
                let count = bytes[begin..].iter().take_while(|byte| digit(byte)).count();
                bytes.splice(begin..begin + count, new.bytes());
            }
        }
        Change::Anything(new) => bytes = new.clone(),
    }
    bytes
}

/// An operation that takes a body: method, path, media type, and an example.
type Operation = (String, String, &'static str, String);

/// Operations that take JSON or a table.
fn operations(document: &Value) -> Vec<Operation> {
    let mut found = Vec::new();
    for (path, operations) in document["paths"].as_object().unwrap() {
        for (method, operation) in operations.as_object().unwrap() {
            let content = &operation["requestBody"]["content"];
            let path = path.replace("{id}", "none").replace("{name}", "none");
            for media in ["application/json", "text/csv"] {
                let example = &content[media]["example"];
                let text = example.as_str().map_or_else(|| example.to_string(), str::to_owned);
                if !example.is_null() {
                    found.push((method.clone(), path.clone(), media, text));
                }
            }
        }
    }
    // Once there is a key, nothing else is answered without one.
    found.sort_by_key(|(_, path, ..)| path == "/v1/keys");
    found
}

fn sent(server: &Server, (method, path, media, _): &Operation, body: &[u8]) -> u16 {
    match method.as_str() {
        "put" => server.put_bytes(path, media, body),
        "patch" => server.patch_bytes(path, media, body),
        _ => server.post(path, media, body).status,
    }
}

#[test]
fn bodies_of_every_operation_are_taken_or_refused() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let operations = operations(&server.get("/openapi.json").json());
    assert!(operations.len() > 3, "{operations:?}");
    let mut failed = Vec::new();
    for operation in &operations {
        for change in drawn(25, changes(), 9) {
            let status = sent(&server, operation, &changed(&operation.3, &change));
            if status >= 500 {
                failed.push((status, operation, change));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
    assert_eq!(server.get("/readyz").status, 200);
    let peak = server.peak_memory_kib();
    assert!(peak.is_none_or(|peak| peak < MOST_KIB), "{peak:?} KiB");
}

#[test]
fn a_file_of_settings_is_taken_or_refused() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("servoscope.toml");
    let text = "listen = \"127.0.0.1:8080\"\nworkers = 2\nkeep_days = 30\nhosts = [\"a\", \"b\"]\n\
        webhook_allow = [\"10.0.0.0/8\"]\nlog_format = \"json\"\nmqtt_topic = \"a/b\"\n";
    for change in drawn(300, changes(), 10) {
        std::fs::write(&file, changed(text, &change)).unwrap();
        if let Err(error) = Settings::read(&file) {
            let told = error.to_string();
            assert!(told.starts_with(file.to_str().unwrap()), "{told}");
        }
    }
}

#[test]
fn a_mapping_is_taken_or_refused_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let [mapping, empty] = ["mapping.toml", "empty.csv"].map(|name| directory.path().join(name));
    std::fs::write(&empty, "").unwrap();
    let text = "sample_s = 0.001\ninput = \"current A\"\ndecimal = \"comma\"\ninverted = false\n";
    for change in drawn(60, changes(), 11) {
        std::fs::write(&mapping, changed(text, &change)).unwrap();
        let files = [&empty, &mapping].map(|path| path.to_str().unwrap());
        let output = servoscope(&["inspect", files[0], "--mapping", files[1]]);
        // The table is empty, so that nothing is computed whatever the mapping says.
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{change:?}: {said}");
        assert!(said.contains("mapping.toml") || said.contains("empty.csv"), "{said}");
    }
}
