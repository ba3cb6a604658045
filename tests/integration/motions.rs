//! A result, tried on records that do not repeat.

use serde_json::{Value, json};
use servoscope_bench::machines::simulator::{Effect, Machine, Samples, Settings, Start, follow};
use servoscope_core::plant::{Actuator, Friction, Plant};

use crate::process::{Server, servoscope, simulated};

const AXIS: [&str; 6] = ["--fs-plus", "0.8", "--fs-minus", "0.7", "--noise-db", "60"];

/// The axis that `servoscope simulate` measures by default.
fn plant() -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(0.5, 0.4),
    }
}

/// A swelling chirp of the axis with static friction, from rest.
fn record(header: &str) -> String {
    let effects = [Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.7)])];
    let at = |t: f64| (0.4 + (0.8 * t).sin().powi(2)) * (t * (3.0 + t)).sin();
    let values: Vec<f64> = (0..=2500).map(|n| at(f64::from(n) * 4e-3)).collect();
    let samples = Samples { step_s: 4e-3, values: &values, hold: false };
    let machine = Machine { plant: plant(), effects: &effects };
    let motion = follow(&machine, 0.0, &samples, &Start::default(), &Settings::default()).unwrap();
    let rows = values.iter().zip(&motion.velocity).enumerate();
    let rows = rows.map(|(n, (u, v))| format!("{:.3},{u:.7},{v:.7}\n", n as f64 * 4e-3));
    format!("{header}time_s,input,output\n{}", rows.collect::<String>())
}

/// A sweep of the axis between two rests.
fn sweep() -> String {
    let at = |t: f64| match t {
        0.5..8.5 => 2.0 * (t - 0.5).min(8.5 - t).min(1.0) * (t * (2.0 + t)).sin(),
        _ => 0.0,
    };
    let values: Vec<f64> = (0..2500).map(|n| at(f64::from(n) * 4e-3)).collect();
    let samples = Samples { step_s: 4e-3, values: &values, hold: false };
    let machine = Machine { plant: plant(), effects: &[] };
    let motion = follow(&machine, 0.0, &samples, &Start::default(), &Settings::default()).unwrap();
    let noise = |n: usize| 2e-3 * (n as f64 * n as f64 * 0.37).sin();
    let rows = values.iter().zip(&motion.velocity).enumerate();
    let rows =
        rows.map(|(n, (u, v))| format!("{:.3},{u:.7},{:.7}\n", n as f64 * 4e-3, v + noise(n)));
    format!("time_s,input,output\n{}", rows.collect::<String>())
}

fn quickly() -> Value {
    json!({"network": {"enabled": false}, "colony": {"enabled": false}})
}

fn printed(arguments: &[&str]) -> String {
    let output = servoscope(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_diagnosis_is_validated_on_a_record_that_does_not_repeat() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| {
        let path = directory.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let fitted = write("sticky.csv", &simulated(&AXIS));
    let given = write("given.csv", record("# initial_velocity: 0\n").as_bytes());
    let silent = write("silent.csv", record("").as_bytes());
    let options = quickly().to_string();
    let diagnose = ["diagnose", &fitted, "--actuator-order", "0", "--options", &options];
    let text = printed(&[&diagnose[..], &["--validate", &given, "--json"]].concat());
    let result: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(result["verdict"], "explained", "{}", result["discrepancy"]);
    let validation = &result["validation"];
    assert_eq!(validation["models"]["extended"]["components"], 2501);
    assert_eq!(validation["motions"][0]["beginning_given"], true);
    assert_eq!(result["gain"], validation["gain"]);
    // Fitted at 60 dB: parameters err by parts in a thousand.
    let left = |model: &str| validation["models"][model]["nrmse"].as_f64().unwrap();
    assert!(left("extended") < 0.02 && left("base") > 2.0 * left("extended"), "{validation}");
    assert!(result["gain"]["interval95"][0].as_f64().unwrap() > 1.0, "{}", result["gain"]);

    let stored = write("result.json", text.as_bytes());
    let again: Value =
        serde_json::from_str(&printed(&["validate", &stored, &given, "--json"])).unwrap();
    assert_eq!(&again, validation);
    let report = printed(&["validate", &stored, &silent]);
    assert!(report.starts_with("CONFIRMED"), "{report}");
    assert!(
        report.contains("the initial state is estimated from the first")
            && report.contains("at rest"),
        "{report}"
    );

    let output = servoscope(&["identify", &silent]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("does not repeat") && error.contains("period_s"), "{error}");
}

#[test]
fn a_server_takes_a_record_that_does_not_repeat_for_a_validation_alone() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let upload = |table: &[u8]| {
        let added = server.post("/v1/measurements", "text/csv", table);
        assert_eq!(added.status, 201, "{}", added.text);
        added.json()
    };
    let fitted = upload(&simulated(&AXIS));
    let motion = upload(record("# period_s: none\n").as_bytes());
    assert_eq!((&motion["experiments"], &motion["highest_harmonic"]), (&json!(1), &json!(0)));
    assert!(motion["notes"].to_string().contains("does not repeat"), "{motion}");
    let plant = json!({"actuator_order": 0});
    let submit = |measurement: &Value| {
        server.submit(&json!({
            "measurement_id": measurement["id"], "kind": "identify", "plant": plant,
            "options": quickly(),
        }))
    };
    let (identified, refused) = (submit(&fitted), submit(&motion));
    let ended = server.ended(&refused);
    assert_eq!(ended["status"], "failed", "{ended}");
    assert!(ended.to_string().contains("does not repeat"), "{ended}");
    assert_eq!(server.ended(&identified)["status"], "succeeded");
    let job = identified.rsplit('/').next().unwrap();
    let body = json!({"job_id": job, "measurement_id": motion["id"]}).to_string();
    let answer = server.post("/v1/validations", "application/json", body.as_bytes());
    assert_eq!(answer.status, 200, "{}", answer.text);
    let validation = answer.json();
    assert_eq!(validation["motions"][0]["beginning_given"], false, "{validation}");
    assert!(validation["models"]["base"]["nrmse"].as_f64().unwrap() > 0.02, "{validation}");
}

// The tolerance is more than six of the standard deviations that the answer states: 0.045 % of the
// friction, less of the others.
#[test]
fn an_axis_is_identified_from_a_sweep_that_begins_and_ends_at_rest() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("sweep.csv");
    std::fs::write(&path, sweep()).unwrap();
    let path = path.to_str().unwrap();
    let options = quickly().to_string();
    let arguments = ["identify", path, "--actuator-order", "0", "--options", &options, "--json"];
    let result: Value = serde_json::from_str(&printed(&arguments)).unwrap();
    let truth = [("pole", -10.0), ("constant", 10.0), ("fc_plus", 0.5), ("fc_minus", 0.4)];
    for (name, value) in truth {
        let found = result["parameters"][name]["value"].as_f64().unwrap();
        assert!((found / value - 1.0_f64).abs() < 3e-3, "{name}: {found}");
    }
    let said = result["limitations"].to_string();
    assert!(said.contains("begins and ends at rest"), "{said}");
}
