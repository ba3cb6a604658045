//! The service as a process: what outlives it and how it ends.

use std::io::{BufRead, BufReader};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::process::{Answer, Server, servoscope, simulated};

pub fn problem(answer: &Answer, status: u16) -> Value {
    assert_eq!(answer.status, status, "{}", answer.text);
    assert_eq!(answer.content_type, "application/problem+json");
    answer.json()
}

/// All items of a list, page by page.
pub fn items(server: &Server, list: &str) -> Vec<Value> {
    let (mut items, mut cursor) = (Vec::new(), String::new());
    loop {
        let page = server.get(&format!("{list}?limit=200{cursor}")).json();
        items.extend(page["items"].as_array().unwrap().iter().cloned());
        let Some(next) = page["next"].as_str() else { return items };
        cursor = format!("&cursor={next}");
    }
}

/// Uploads the first system of the paper and queues a job, whose path it returns.
pub fn submit(server: &Server, options: &Value) -> String {
    let measurement = server.post("/v1/measurements?name=g1", "text/csv", &simulated(&[]));
    assert_eq!(measurement.status, 201, "{}", measurement.text);
    server.submit(&json!({
        "measurement_id": measurement.json()["id"], "kind": "identify",
        "plant": {"actuator_order": 0}, "options": options,
    }))
}

/// A request that takes far longer than any test waits.
pub fn endless() -> Value {
    json!({"colony": {"food_sources": 1000, "cycles": 1000, "abandonment_limit": 1_000_000}})
}

#[test]
fn a_server_is_ready_and_stops_when_it_is_asked_to() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(server.get("/livez").status, 200);
    assert_eq!(server.terminate(), Some(0));
}

#[test]
fn a_server_refuses_what_is_wrong_with_problem_documents() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &["--max-upload-mib", "8"]);
    problem(&server.get("/v1/nothing"), 404);
    // Larger than what the kernel takes off the client's hands: the answer must
    // not be lost in a broken connection.
    problem(&server.post("/v1/measurements", "image/png", &vec![b'x'; 7 << 20]), 415);
    problem(&server.post("/v1/measurements", "text/csv", &vec![b'x'; 9 << 20]), 413);
    let unreadable = problem(&server.post("/v1/measurements?name=a", "text/csv", b"x"), 422);
    assert_eq!(unreadable["file"], "a.csv");
    let body = json!({"measurement_id": "nobody", "kind": "identify"}).to_string();
    problem(&server.post("/v1/jobs", "application/json", body.as_bytes()), 404);
}

#[test]
fn a_second_server_on_a_folder_is_refused_until_the_first_one_is_killed() {
    let directory = tempfile::tempdir().unwrap();
    let first = Server::start(directory.path(), &[]);
    let folder = directory.path().to_str().unwrap();
    let refused = servoscope(&["serve", "--listen", "127.0.0.1:0", "--data-dir", folder]);
    assert_eq!(refused.status.code(), Some(1));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains(&format!("another server runs on {folder}; stop it first")), "{said}");
    assert_eq!(first.get("/readyz").status, 200);
    first.kill();
    assert_eq!(Server::start(directory.path(), &[]).get("/readyz").status, 200);
}

#[test]
fn a_job_goes_from_upload_to_the_parameters() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let job = submit(&server, &json!({"noise_std": 0.001}));
    let ended = server.ended(&job);
    assert_eq!(ended["status"], "succeeded", "{ended}");
    let result = server.get(&format!("{job}/result")).json();
    // The data is free of noise: 0.01 % is far more than the fit may miss.
    for (name, truth) in [("pole", -10.0), ("constant", 10.0), ("fc_plus", 0.5), ("fc_minus", 0.4)]
    {
        let value = result["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-4, "{name}: {value}, not {truth}");
    }
    let history = server.get(&format!("{job}/convergence")).json();
    assert!(!history["rows"].as_array().unwrap().is_empty());
}

#[test]
fn a_running_job_is_cancelled() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let job = submit(&server, &endless());
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    let ended = server.ended(&job);
    assert_eq!(ended["status"], "cancelled", "{ended}");
}

#[test]
fn jobs_survive_a_killed_server() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &["--workers", "1"]);
    let running = submit(&server, &endless());
    let queued = submit(&server, &json!({"seed": 5}));
    server.kill();

    let server = Server::start(directory.path(), &["--workers", "1"]);
    assert_eq!(server.post(&format!("{running}/cancel"), "text/plain", b"").status, 202);
    let ended = server.ended(&queued);
    assert_eq!(ended["status"], "succeeded", "{ended}");
    let cancelled = server.ended(&running);
    assert_eq!(cancelled["status"], "cancelled", "{cancelled}");
}

#[test]
fn a_stopping_server_hands_its_job_to_the_next() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let job = submit(&server, &endless());
    assert_eq!(server.terminate(), Some(0));
    let server = Server::start(directory.path(), &["--workers", "1"]);
    let resumed = server.get(&job).json();
    assert!(["queued", "running"].contains(&resumed["status"].as_str().unwrap()), "{resumed}");
}

#[test]
fn a_stream_that_has_nothing_to_say_says_that_it_is_alive() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &["--workers", "1"]);
    submit(&server, &endless());
    let waiting = submit(&server, &json!({"seed": 5}));
    let stream = ureq::get(format!("{}{waiting}/events", server.address())).call().unwrap();
    let mut lines = BufReader::new(stream.into_body().into_reader()).lines().map(Result::unwrap);
    assert_eq!(lines.next().as_deref(), Some("event: status"));
    // A comment: a line that begins with a colon. Proxies wait a minute for it.
    let began = Instant::now();
    assert!(lines.any(|line| line.starts_with(':')), "the stream was closed");
    assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
}
