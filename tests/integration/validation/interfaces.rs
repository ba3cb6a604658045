//! Results tried on another measurement through the program and the server.

use std::path::Path;

use serde_json::{Value, json};

use crate::process::{Server, servoscope, simulated};

use super::quickly;

/// Simulates a file of the same sticky axis.
fn file(folder: &Path, name: &str, arguments: &[&str]) -> String {
    let axis = ["--fs-plus", "0.8", "--fs-minus", "0.7", "--noise-db", "60"];
    let path = folder.join(name);
    std::fs::write(&path, simulated(&[&axis, arguments].concat())).unwrap();
    path.to_str().unwrap().to_owned()
}

const OTHER: [&str; 6] = ["--seed", "9", "--magnitudes", "1.5,3", "--frequency-range", "0.7:60:15"];

fn printed(arguments: &[&str]) -> String {
    let output = servoscope(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(arguments: &[&str]) -> String {
    let output = servoscope(arguments);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_diagnosis_measures_its_gain_on_a_second_file_and_validate_finds_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let fitted = file(directory.path(), "sticky.csv", &[]);
    let other = file(directory.path(), "other.csv", &OTHER);
    let options = quickly().to_string();
    let diagnose = ["diagnose", &fitted, "--actuator-order", "0", "--options", &options];
    let text = printed(&[&diagnose[..], &["--validate", &other, "--json"]].concat());
    let result: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(result["verdict"], "explained", "{}", result["discrepancy"]);
    assert!(result["gain"]["interval95"][0].as_f64().unwrap() > 1.0, "{}", result["gain"]);
    assert_eq!(result["causes"][0]["gain"], result["gain"]);
    let stored = directory.path().join("result.json");
    std::fs::write(&stored, &text).unwrap();
    let stored = stored.to_str().unwrap();
    let again: Value =
        serde_json::from_str(&printed(&["validate", stored, &other, "--json"])).unwrap();
    assert_eq!(again, result["validation"]);
    let report = printed(&["validate", stored, &other]);
    assert!(report.starts_with("CONFIRMED") && report.contains("verdict EXPLAINED"), "{report}");

    // What is measured as a position is compared as a position.
    let position =
        file(directory.path(), "position.csv", &[&OTHER[..], &["--response", "position"]].concat());
    let there: Value =
        serde_json::from_str(&printed(&["validate", stored, &position, "--json"])).unwrap();
    assert_eq!(there["response_quantity"], "position");
    // 30 experiments, harmonics 1 to 7: the mean of a position is not compared.
    assert_eq!(there["models"]["extended"]["components"], 210);
    let each = there["models"]["extended"]["chi2_per_dof"].as_f64().unwrap();
    // Noise alone, within 4 deviations.
    assert!((each - 1.0).abs() < 4.0 * (2.0 / 420.0_f64).sqrt(), "{there}");

    let mut wrong = result;
    wrong["validation"] = Value::Null;
    for name in ["static_friction.fs_plus", "static_friction.fs_minus"] {
        let value = &mut wrong["extended"]["parameters"][name]["value"];
        *value = json!(1.3 * value.as_f64().unwrap());
    }
    std::fs::write(stored, wrong.to_string()).unwrap();
    let report = printed(&["validate", stored, &other]);
    assert!(report.starts_with("CONTRADICTED") && report.contains("verdict IMPROVED"), "{report}");
}

#[test]
fn what_cannot_be_validated_is_refused_with_its_reason() {
    let directory = tempfile::tempdir().unwrap();
    let fitted = file(directory.path(), "fitted.csv", &["--input-unit", "A"]);
    let volts = file(directory.path(), "volts.csv", &["--input-unit", "V"]);
    let identify = ["identify", &fitted, "--actuator-order", "0", "--json"];
    let stored = directory.path().join("result.json");
    let options = quickly().to_string();
    std::fs::write(&stored, printed(&[&identify[..], &["--options", &options]].concat())).unwrap();
    let stored = stored.to_str().unwrap();
    let error = refused(&["validate", stored, &volts]);
    assert!(error.contains("volts.csv") && error.contains("its input is in V"), "{error}");
    let error = refused(&["validate", &fitted, &volts]);
    assert!(error.contains("fitted.csv: not a result that"), "{error}");
    assert!(refused(&["validate", "nowhere.json", &volts]).contains("nowhere.json"));
    assert!(refused(&["validate", stored]).contains("<FILE>"));
    let error = refused(&["diagnose", &fitted, "--validate", &volts]);
    assert!(error.contains("--validate") && error.contains("its input is in V"), "{error}");
    let error = refused(&["diagnose", &fitted, "--validate", &fitted]);
    assert!(error.contains("proves nothing"), "{error}");
    assert!(refused(&["diagnose", &fitted, "--validate", "gone.csv"]).contains("gone.csv"));
}

#[test]
fn a_server_diagnoses_with_a_second_measurement_and_tries_results_on_it() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let upload = |arguments: &[&str]| {
        let axis = ["--fs-plus", "0.8", "--fs-minus", "0.7", "--noise-db", "60"];
        let table = simulated(&[&axis, arguments].concat());
        let added = server.post("/v1/measurements", "text/csv", &table);
        added.json()["id"].as_str().unwrap().to_owned()
    };
    let (fitted, other) = (upload(&[]), upload(&OTHER));
    let plant = json!({"actuator_order": 0});
    let diagnosed = server.submit(&json!({
        "measurement_id": fitted, "kind": "diagnose", "plant": plant, "options": quickly(),
        "validation_measurement_id": other,
    }));
    let identified = server.submit(&json!({
        "measurement_id": fitted, "kind": "identify", "plant": plant, "options": quickly(),
    }));
    let validate = |job: &str| {
        let job = job.rsplit('/').next().unwrap();
        let body = json!({"job_id": job, "measurement_id": other}).to_string();
        let answer = server.post("/v1/validations", "application/json", body.as_bytes());
        assert_eq!(answer.status, 200, "{}", answer.text);
        answer.json()
    };
    let job = server.ended(&identified);
    assert_eq!(job["status"], "succeeded", "{job}");
    let base = validate(&identified);
    assert_eq!((&base["verdict"], &base["models"]["extended"]), (&Value::Null, &Value::Null));
    let job = server.ended(&diagnosed);
    assert_eq!(job["status"], "succeeded", "{job}");
    let result = server.get(&format!("{diagnosed}/result")).json();
    assert!(result["gain"]["ratio"].as_f64().unwrap() > 1.0, "{}", result["gain"]);
    assert_eq!(validate(&diagnosed), result["validation"]);
    // The same base model, fitted in both jobs.
    assert_eq!(base["models"]["base"], result["validation"]["models"]["base"]);
}
