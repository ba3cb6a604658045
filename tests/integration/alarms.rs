//! What the page for operators says of metrics, alarms and log lines.

use std::collections::BTreeSet;
use std::path::Path;

use crate::process::{Server, repository, simulated};

fn text(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap()
}

/// Names of metrics that a text mentions.
fn named(text: &str) -> BTreeSet<&str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with("servoscope_")).collect()
}

/// The name of a family without what its samples add.
fn family(name: &str) -> &str {
    ["_bucket", "_count", "_sum"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name)
}

/// What a server exports that has run a job; no message was ever sent.
fn exported() -> BTreeSet<String> {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let table = simulated(&["--frequencies-rad-s", "2,10,40", "--noise-db", "60"]);
    let measurement = server.post("/v1/measurements", "text/csv", &table).json()["id"].clone();
    let request = serde_json::json!({
        "measurement_id": measurement, "kind": "identify", "plant": {"actuator_order": 0},
        "method": "two-magnitude",
    });
    assert_eq!(server.ended(&server.submit(&request))["status"], "succeeded");
    let metrics = server.get("/metrics").text;
    let samples = metrics.lines().filter(|line| !line.starts_with('#'));
    let names = samples.map(|line| family(line.split(['{', ' ']).next().unwrap()).to_owned());
    let mut names: BTreeSet<String> = names.collect();
    // It has no sample before the first message; a unit test of the metrics holds its name.
    names.insert("servoscope_messages_total".into());
    names
}

#[test]
fn the_page_explains_every_metric_and_the_alarms_use_no_other() {
    let exported = exported();
    let page = text("docs/metrics.md");
    let rows = page.lines().filter(|line| line.starts_with("| `servoscope_"));
    let explained: BTreeSet<String> =
        rows.map(|row| row.split('`').nth(1).unwrap().to_owned()).collect();
    assert_eq!(explained, exported);
    let alarms = text("docs/alarms.yaml");
    let used: BTreeSet<&str> = named(&alarms).into_iter().map(family).collect();
    assert!(used.len() > 5, "{used:?}");
    assert!(used.iter().all(|name| exported.contains(*name)), "{used:?}, but {exported:?}");
}

#[test]
fn every_alarm_has_a_heading_that_says_what_to_do() {
    let (page, alarms) = (text("docs/metrics.md"), text("docs/alarms.yaml"));
    let names: Vec<&str> =
        alarms.lines().filter_map(|line| line.trim().strip_prefix("- alert: ")).collect();
    assert!(names.len() > 5);
    for name in names {
        assert!(page.contains(&format!("\n### {name}\n")), "{name}");
        let runbook = format!("runbook: \"docs/metrics.md#{}\"", name.to_lowercase());
        assert!(alarms.contains(&runbook), "{runbook}");
    }
}

/// Messages of the log in the sources under a folder.
fn messages(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            messages(&path, found);
            continue;
        }
        let source = std::fs::read_to_string(&path).unwrap_or_default();
        for level in ["info!(", "warn!(", "error!("] {
            // The last text of a macro is its message.
            let calls = source.split(level).skip(1).map(|rest| rest.split(")").next().unwrap());
            let texts = calls.filter_map(|call| call.rsplit('"').nth(1));
            found.extend(texts.map(str::to_owned));
        }
    }
}

#[test]
fn the_page_explains_every_line_of_the_log() {
    let page = text("docs/metrics.md");
    let mut found = BTreeSet::new();
    messages(&repository("src"), &mut found);
    assert!(found.len() > 25, "{found:?}");
    let missing: Vec<&String> =
        found.iter().filter(|message| !page.contains(&format!("\n| {message} | "))).collect();
    assert!(missing.is_empty(), "docs/metrics.md lacks {missing:#?}");
}
