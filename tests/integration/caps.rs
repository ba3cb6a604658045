//! What a server takes at most, and that it says so before anything is stored.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::process::{Answer, Server, simulated};
use crate::service::problem;

/// The server refuses an upload; what it says of it.
fn refused(answer: &Answer) -> Value {
    let problem = problem(answer, 422);
    assert_ne!(problem["detail"], "", "{problem}");
    problem
}

fn says(problem: &Value, words: &str) -> bool {
    problem["detail"].as_str().unwrap().contains(words)
}

/// As many files of a form, each a measurement.
fn form(files: usize) -> Vec<u8> {
    let file = |index: usize| {
        format!(
            "--X\r\ncontent-disposition: form-data; name=\"f\"; filename=\"{index}.csv\"\r\n\r\n\
             magnitude,omega_rad_s,re,im\n1,{index}.5,1,0\n\r\n"
        )
    };
    format!("{}--X--\r\n", (0..files).map(file).collect::<String>()).into_bytes()
}

/// A table of so many experiments.
fn experiments(count: usize) -> Vec<u8> {
    let mut table = String::from("magnitude,omega_rad_s,re,im\n");
    for index in 1..=count {
        writeln!(table, "1,{index},1,0").unwrap();
    }
    table.into_bytes()
}

/// A table of so many rows, each the same harmonic of a repeat of its own.
fn rows(count: usize) -> Vec<u8> {
    let mut table = String::from("magnitude,omega_rad_s,re,im,repeat\n");
    for index in 1..=count {
        writeln!(table, "1,1,1,0,{index}").unwrap();
    }
    table.into_bytes()
}

#[test]
fn files_experiments_rows_harmonics_and_nesting_have_limits_that_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let multipart = "multipart/form-data; boundary=X";
    let files = refused(&server.post("/v1/measurements", multipart, &form(65)));
    assert!(files["member"] == "files" && says(&files, "65") && says(&files, "64"), "{files}");

    let csv = |table: &[u8]| server.post("/v1/measurements", "text/csv", table);
    let points = refused(&csv(&experiments(20_001)));
    assert!(points["member"] == "experiments" && says(&points, "20000"), "{points}");

    let long = refused(&csv(&rows(2_000_001)));
    assert!(says(&long, "2000000 rows") && long["line"] == 2_000_002, "{long}");

    let high = refused(&csv(b"magnitude,omega_rad_s,harmonic,re,im\n1,1,100001,1,0\n"));
    assert!(says(&high, "100000") && high["line"] == 2, "{high}");

    let json = |text: &str| server.post("/v1/measurements", "application/json", text.as_bytes());
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    for text in [deep.clone(), format!("{{\"rows\": {deep}}}"), format!("{{\"colour\": {deep}}}")] {
        let nested = refused(&json(&text));
        assert!(says(&nested, "recursion limit") && nested["line"] == 1, "{nested}");
    }
    // Nothing of any of them was stored, and what is within the limits is taken.
    assert_eq!(server.get("/v1/measurements").json()["items"], json!([]));
    assert_eq!(server.post("/v1/measurements", multipart, &form(64)).status, 201);
    assert_eq!(csv(&experiments(20_000)).status, 201);
}

#[test]
fn no_option_makes_a_job_endless() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let measurement = server.post("/v1/measurements", "text/csv", &simulated(&[])).json();
    for (member, options) in [
        ("network.hidden_neurons", json!({"network": {"hidden_neurons": 201}})),
        ("network.training_plants", json!({"network": {"training_plants": 20_001}})),
        ("network.epochs", json!({"network": {"epochs": 5_001}})),
        (
            "network.training_plants × network.epochs",
            json!({"network": {"training_plants": 20_000, "epochs": 501}}),
        ),
        ("colony.food_sources", json!({"colony": {"food_sources": 1_001}})),
        ("colony.cycles", json!({"colony": {"cycles": 10_001}})),
        (
            "colony.food_sources × colony.cycles",
            json!({"colony": {"food_sources": 1_000, "cycles": 1_001}}),
        ),
        ("colony.abandonment_limit", json!({"colony": {"abandonment_limit": 1_000_001}})),
        ("most_effects", json!({"most_effects": 4})),
    ] {
        let body = json!({
            "measurement_id": measurement["id"], "kind": "diagnose", "options": options,
        });
        let answer = server.post("/v1/jobs", "application/json", body.to_string().as_bytes());
        let refused = refused(&answer);
        assert_eq!(refused["member"], format!("options.{member}"), "{refused}");
        assert!(says(&refused, "is outside "), "{refused}");
    }
    assert_eq!(server.get("/v1/jobs").json()["items"], json!([]));
}
