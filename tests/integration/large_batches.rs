//! Batches of a thousand measurements.

use serde_json::{Value, json};

use crate::batches::{count, has_ended, until};
use crate::process::{Server, simulated};
use crate::service::items;
use crate::worker_process::QUICK;

const JOBS: usize = 1000;

fn start(folder: &std::path::Path, workers: &str) -> Server {
    Server::start(folder, &[&["--workers", workers], &QUICK[..]].concat())
}

/// Uploads the measurements and makes a batch of them, whose path it gives.
fn batch(server: &Server) -> String {
    let table = simulated(&[]);
    let uploaded = |place: usize| {
        let path = format!("/v1/measurements?name=run-{place}.csv");
        let measurement = server.post(&path, "text/csv", &table);
        assert_eq!(measurement.status, 201, "{}", measurement.text);
        measurement.json()["id"].clone()
    };
    let ids: Vec<Value> = (0..JOBS).map(uploaded).collect();
    let body = json!({
        "kind": "identify", "method": "least-squares", "measurement_ids": ids,
        "plant": {"actuator_order": 0},
    });
    let made = server.post("/v1/batches", "application/json", body.to_string().as_bytes());
    assert_eq!(made.status, 202, "{}", made.text);
    assert_eq!(made.json()["jobs"], JOBS);
    format!("/v1/batches/{}", made.json()["id"].as_str().unwrap())
}

/// All rows of its table.
fn rows(server: &Server, batch: &str) -> Vec<Value> {
    items(server, &format!("{batch}/results"))
}

#[test]
#[ignore = "slow: 1000 identifications"]
fn a_batch_of_a_thousand_shows_what_it_has_and_is_finished_after_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), "2");
    let path = batch(&server);
    until(&server, &path, |batch| count(batch, "succeeded") >= 50);
    let partial = rows(&server, &path);
    assert_eq!(partial.len(), JOBS);
    let known = |state: &str| partial.iter().filter(|row| row["state"] == state).count();
    assert!(known("succeeded") >= 50 && known("queued") > 0, "it is in the middle");
    server.kill();

    let server = start(folder.path(), "2");
    let resumed = server.get(&path).json();
    assert!(count(&resumed, "succeeded") >= 50, "{resumed}");
    let ended = until(&server, &path, has_ended);
    assert_eq!(count(&ended, "succeeded"), JOBS, "{ended}");
    let rows = rows(&server, &path);
    assert_eq!(rows.len(), JOBS);
    for (place, row) in rows.iter().enumerate() {
        let expected = (json!(format!("run-{place}.csv")), json!("succeeded"));
        assert_eq!((&row["file"], &row["state"]), (&expected.0, &expected.1));
    }
    let table = server.get(&format!("{path}/results.csv"));
    assert_eq!(table.text.lines().filter(|line| line.contains("run-")).count(), JOBS);
}

#[test]
#[ignore = "slow: 1000 measurements"]
fn a_batch_of_a_thousand_is_cancelled_at_once_and_stays_so() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), "0");
    let path = batch(&server);
    let waiting = server.get(&path).json();
    assert_eq!((count(&waiting, "queued"), &waiting["state"]), (JOBS, &json!("queued")));
    assert_eq!(server.post(&format!("{path}/cancel"), "text/plain", b"").status, 202);
    assert_eq!(count(&server.get(&path).json(), "cancelled"), JOBS);
    server.kill();

    let server = start(folder.path(), "2");
    let cancelled = server.get(&path).json();
    assert_eq!(
        (count(&cancelled, "cancelled"), has_ended(&cancelled)),
        (JOBS, true),
        "{cancelled}"
    );
    assert!(rows(&server, &path).iter().all(|row| row["state"] == "cancelled"));
}
