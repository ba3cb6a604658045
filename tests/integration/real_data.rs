//! Real machines, through the command line and over HTTP.

use serde_json::{Value, json};

use crate::process::{Server, servoscope};
use crate::shared_files::shared;

/// Published mass of the positioning stage, kg.
const EMPS_MASS_KG: f64 = 95.1089;

fn by_command_line(arguments: &[&str]) -> Value {
    let output = servoscope(&[&["identify", "--json"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn over_http(record: &[u8], plant: &Value, options: &Value) -> Value {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let measurement = server.post("/v1/measurements", "text/csv", record);
    assert_eq!(measurement.status, 201, "{}", measurement.text);
    let job = server.submit(&json!({
        "measurement_id": measurement.json()["id"], "kind": "identify",
        "plant": plant, "options": options,
    }));
    let ended = server.ended(&job);
    assert_eq!(ended["status"], "succeeded", "{ended}");
    let history = server.get(&format!("{job}/convergence")).json();
    assert!(!history["rows"].as_array().unwrap().is_empty());
    server.get(&format!("{job}/result")).json()
}

#[test]
fn the_mass_of_the_positioning_stage_is_the_published_one() {
    let Some(file) = shared("data/emps/emps.csv") else { return };
    let result = by_command_line(&["--actuator-order", "0", file.to_str().unwrap()]);
    let mass_kg = 1.0 / result["parameters"]["constant"]["value"].as_f64().unwrap();
    // Another method and another friction model found the published value.
    assert!((mass_kg / EMPS_MASS_KG - 1.0).abs() < 0.03, "{mass_kg} kg");
    assert_eq!(result["parameters"]["constant"]["unit"], "(m/s)/(N·s)");
    assert_eq!(result["noise"], "periods");

    let record = std::fs::read(&file).unwrap();
    let served = over_http(&record, &json!({"actuator_order": 0}), &json!({}));
    // The same data, options and seed: the same bits.
    assert_eq!(served["parameters"], result["parameters"]);
    assert_eq!(served["provenance"], result["provenance"]);
}

/// The bench is two masses on a shaft, with an antiresonance at 57 Hz and a resonance at 79 Hz,
/// which no base model has: an answer says that it is wrong by far more than the noise, and how
/// little its parameters are worth.
fn is_an_answer_for_the_motor_bench(result: &Value) {
    assert_eq!(result["noise"], "periods");
    let fit = &result["fit"];
    assert_eq!(fit["adequate"], false);
    let per_dof = fit["chi2_per_dof"].as_f64().unwrap();
    assert!(per_dof > 1000.0, "{per_dof}");
    let widened = fit["uncertainty_scale"].as_f64().unwrap();
    assert!((widened / per_dof.sqrt() - 1.0).abs() < 1e-12, "{widened}");
    assert_eq!(fit["unanswered"], json!([]));
    let said = result["limitations"].to_string();
    assert!(said.contains("18 whole periods of 1 s") && said.contains("up to 654 are used"));
    assert!(said.contains("does not fit to within the noise"), "{said}");
    // Two real numbers of each harmonic and the mean; at most six parameters are fitted.
    let dof = fit["dof"].as_i64().unwrap();
    assert!((2 * 654 + 1 - 6..=2 * 654 + 1).contains(&dof), "{dof}");
    let parameters = &result["parameters"];
    assert_eq!(parameters["constant"]["unit"], "(rad/s)/(A·s)");
    assert_eq!(parameters["fc_plus"]["unit"], "A");
    assert!(parameters["pole"]["value"].as_f64().unwrap() < 0.0);
    assert!(parameters["constant"]["value"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_motor_bench_has_an_answer() {
    let Some(file) = shared("data/motor-bench/multisine_a.csv") else { return };
    // The stages that dominate the time of a record with so many lines, cut short.
    let options = json!({"network": {"enabled": false}, "colony": {"cycles": 5}});
    let text = options.to_string();
    let path = file.to_str().unwrap();
    let result = by_command_line(&["--actuator-order", "0", "--options", &text, path]);
    is_an_answer_for_the_motor_bench(&result);
    let record = std::fs::read(&file).unwrap();
    let served = over_http(&record, &json!({"actuator_order": 0}), &options);
    assert_eq!(served["parameters"], result["parameters"]);
}

#[test]
#[ignore = "slow: three orders of a record with 1250 lines"]
fn the_motor_bench_has_an_answer_by_default_options() {
    let Some(file) = shared("data/motor-bench/multisine_a.csv") else { return };
    let result = by_command_line(&[file.to_str().unwrap()]);
    is_an_answer_for_the_motor_bench(&result);
    // With an actuator the model leaves less than if it said nothing.
    assert!(result["fit"]["nrmse"].as_f64().unwrap() < 1.0);
    assert_eq!(result["order_choice"]["candidates"].as_array().unwrap().len(), 3);
}

/// A motor drives an arm through springs. Of all lines between 1.8 and 3 Hz the response is least at
/// 2.35 Hz.
#[test]
#[ignore = "slow: a diagnosis of a record with 200 excited lines"]
fn the_joint_of_the_flexible_arm_is_named() {
    let Some(file) = shared("data/flexible-joint/multisine.csv") else { return };
    let output = servoscope(&["diagnose", "--json", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let causes = result["causes"].as_array().unwrap();
    let is_joint = |cause: &&Value| cause["effect"] == "flexible_mode";
    let joint = causes.iter().find(is_joint).unwrap_or_else(|| panic!("{causes:?}"));
    let value = |of: &Value, name: &str| of[name]["value"].as_f64().unwrap();
    let parameters = &result["extended"]["parameters"];
    let [stiffness, share] =
        ["stiffness", "load_inertia_fraction"].map(|name| value(&joint["parameters"], name));
    let antiresonance_hz =
        (stiffness * value(parameters, "constant") / share).sqrt() / std::f64::consts::TAU;
    assert!((2.1..2.7).contains(&antiresonance_hz), "{antiresonance_hz} Hz");
}

/// Left to the data, the order would be 2, with a resonance at 24 Hz that no line shows.
#[test]
#[ignore = "slow: two diagnoses of a record with 1114 lines"]
fn the_positioning_stage_has_the_same_cause_and_no_resonance_whether_an_order_is_given_or_not() {
    let Some(file) = shared("data/emps/emps.csv") else { return };
    let diagnosed = |more: &[&str]| -> Value {
        let output = servoscope(&[&["diagnose", "--json", file.to_str().unwrap()], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let [open, given] = [&[][..], &["--actuator-order", "0"]].map(diagnosed);
    let confidence = |result: &Value| {
        assert_eq!(result["causes"][0]["effect"], "viscous_asymmetry", "{}", result["causes"]);
        result["causes"][0]["confidence"].as_f64().unwrap()
    };
    // Both are the same model, to within how far its fits go.
    let [open_confidence, given_confidence] = [&open, &given].map(confidence);
    assert!((open_confidence - given_confidence).abs() < 0.01);
    assert!(open["extended"]["parameters"].get("natural_frequency").is_none());
    assert_eq!(open["valid_band"]["departures"], json!([]));
}
