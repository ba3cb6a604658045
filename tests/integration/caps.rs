//! What a server takes at most, and that it says so before anything is stored.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::process::{Answer, Server, repository, simulated};
use crate::service::problem;
use crate::shared_files::shared;

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

/// A JSON upload with so many members that nobody knows.
fn unknown_members(count: usize) -> Vec<u8> {
    let mut text =
        String::from("{\"rows\": [{\"magnitude\": 1, \"omega_rad_s\": 1, \"re\": 1, \"im\": 0}]");
    for index in 0..count {
        write!(text, ", \"member_{index}\": {index}").unwrap();
    }
    text.push('}');
    text.into_bytes()
}

#[test]
fn notes_and_pages_of_lists_stay_small_whatever_was_uploaded() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let upload = unknown_members(50_000);
    for _ in 0..20 {
        let stored = server.post("/v1/measurements", "application/json", &upload);
        assert_eq!(stored.status, 201, "{}", stored.text);
        let notes = stored.json()["notes"].as_array().unwrap().clone();
        assert!(notes.len() <= 100, "{}", notes.len());
        let last = notes.last().unwrap().as_str().unwrap();
        assert_eq!(last, format!("… and {} more", 50_000 - (notes.len() - 1)));
    }
    // 20 times the notes of one measurement, and what else is said of it.
    let list = server.get("/v1/measurements?limit=200").text;
    assert!(list.len() < 20 * 20_000, "{} bytes", list.len());
    let long = format!("# machine: {}\nmagnitude,omega_rad_s,re,im\n1,1,1,0\n", "x".repeat(1001));
    let refused = refused(&server.post("/v1/measurements", "text/csv", long.as_bytes()));
    assert!(refused["column"] == "machine" && says(&refused, "1001 bytes"), "{refused}");
}

#[test]
fn a_job_that_would_compute_for_hours_is_refused_with_what_to_do() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let table = b"magnitude,omega_rad_s,harmonic,re,im\n1,1,1,1,0\n1,1,100000,1e-9,0\n1,2,1,1,0\n";
    let measurement = server.post("/v1/measurements", "text/csv", table);
    assert_eq!(measurement.status, 201, "{}", measurement.text);
    let request = json!({
        "measurement_id": measurement.json()["id"], "kind": "diagnose",
        "plant": {"actuator_order": 0},
    });
    let refused =
        refused(&server.post("/v1/jobs", "application/json", request.to_string().as_bytes()));
    assert_eq!(refused["type"], "urn:servoscope:problem:too-costly");
    for words in ["hours", "60 minutes", "harmonics up to 100000", "--job-cost-minutes"] {
        assert!(says(&refused, words), "{words}: {refused}");
    }
    let id = measurement.json()["id"].as_str().unwrap().to_owned();
    let inspection = problem(&server.get(&format!("/v1/measurements/{id}/inspection")), 422);
    assert_eq!(inspection["type"], "urn:servoscope:problem:too-costly");
}

#[test]
fn a_job_on_every_file_of_the_project_is_accepted() {
    let directory = tempfile::tempdir().unwrap();
    // None of them is to be computed here.
    let server = Server::start(directory.path(), &["--workers", "1"]);
    let reference = std::fs::read_dir(repository("tests/reference")).unwrap();
    let reference = reference.map(|entry| entry.unwrap().path());
    let data = ["emps/emps.csv", "flexible-joint/multisine.csv", "motor-bench/multisine_a.csv"];
    let data = data.iter().filter_map(|name| shared(&format!("data/{name}")));
    let tables = reference.chain(data).filter(|path| path.extension().is_some_and(|e| e == "csv"));
    let mut accepted = 0;
    for path in tables {
        let stored = server.post("/v1/measurements", "text/csv", &std::fs::read(&path).unwrap());
        assert_eq!(stored.status, 201, "{}: {}", path.display(), stored.text);
        // A diagnosis, without an order: as much as the defaults ask for.
        let job =
            server.submit(&json!({"measurement_id": stored.json()["id"], "kind": "diagnose"}));
        let estimate = server.get(&job).json()["estimated_s"].as_f64().unwrap();
        assert!((0.1..600.0).contains(&estimate), "{}: {estimate} s", path.display());
        assert_eq!(server.delete(&job), 204);
        accepted += 1;
    }
    assert!(accepted > 10, "{accepted}");
}

#[test]
fn a_filter_without_a_value_is_refused_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    for (path, member) in [
        ("/v1/history.json?machine=a&axis=b&changed=", "changed"),
        ("/v1/history.json?machine=a&axis=b&changed", "changed"),
        ("/v1/measurements?limit=", "limit"),
        ("/v1/measurements?machine=", "machine"),
        ("/v1/jobs?status=", "status"),
        ("/v1/jobs/none?wait=", "wait"),
        ("/v1/results.json?from=", "from"),
    ] {
        let refused = problem(&server.get(path), 400);
        assert_eq!(refused["member"], member, "{path}: {refused}");
        assert!(says(&refused, "it has no value"), "{path}: {refused}");
    }
}
