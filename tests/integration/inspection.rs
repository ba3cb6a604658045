//! A measurement looked at before anything is computed of it.

use serde_json::Value;

use crate::process::{Server, servoscope, simulated};
use crate::shared_files::shared;

fn printed(arguments: &[&str]) -> String {
    let output = servoscope(&[&["inspect"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn checks(inspection: &Value) -> Vec<&str> {
    let doubts = inspection["doubts"].as_array().unwrap().iter();
    doubts.map(|doubt| doubt["check"].as_str().unwrap()).collect()
}

#[test]
fn a_sound_table_says_what_it_can_show_and_over_http_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g1.csv");
    let table = simulated(&["--noise-db", "60"]);
    std::fs::write(&path, &table).unwrap();
    let path = path.to_str().unwrap();
    let text = printed(&[path]);
    assert!(text.contains("What it can reveal") && !text.contains("Looks wrong"), "{text}");
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(joined.contains("(rms), 60 dB below"), "{text}");
    let printed: Value = serde_json::from_str(&printed(&["--json", path])).unwrap();
    let effects = printed["detectability"]["effects"].as_array().unwrap();
    assert!(printed["noise_std"].as_f64().is_some_and(|std| std > 0.0));
    let seen = effects.iter().filter(|effect| !effect["detected_from"].is_null()).count();
    assert_eq!(seen, effects.len());

    let store = tempfile::tempdir().unwrap();
    let server = Server::start(store.path(), &[]);
    let added = server.post("/v1/measurements", "text/csv", &table).json();
    let id = added["id"].as_str().unwrap();
    let served = server.get(&format!("/v1/measurements/{id}/inspection")).json();
    assert_eq!(served["detectability"], printed["detectability"]);
}

#[test]
fn a_position_that_is_called_a_velocity_and_a_loop_that_is_not_stated_are_seen() {
    let Some(file) = shared("data/emps/emps.csv") else { return };
    let file = file.to_str().unwrap();
    // Order 0 alone: it is the doubts that are tried.
    let inspected = |more: &[&str]| -> Value {
        let arguments = [&["--json", "--actuator-order", "0"], more, &[file]].concat();
        serde_json::from_str(&printed(&arguments)).unwrap()
    };
    assert_eq!(checks(&inspected(&["--loop", "closed"])), [""; 0]);
    let called = inspected(&["--response", "velocity m/s"]);
    assert_eq!(checks(&called), ["position_as_velocity", "closed_loop"]);
}
