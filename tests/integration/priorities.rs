//! Priorities of jobs, over HTTP.

use serde_json::{Value, json};

use crate::durability::{is_running, until};
use crate::process::{Server, simulated};
use crate::service::{endless, problem, submit};

#[test]
fn of_the_jobs_of_one_submitter_the_higher_priority_begins_first() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), &["--workers", "1"]);
    let busy = submit(&server, &endless());
    until(&server, &busy, is_running);
    let measurement = server.post("/v1/measurements", "text/csv", &simulated(&[])).json();
    let body = |priority: Option<&str>| {
        json!({
            "measurement_id": measurement["id"], "kind": "identify", "priority": priority,
            "plant": {"actuator_order": 0}, "options": {"seed": 5},
        })
    };
    let asked = |path: &str, body: &Value| {
        server.post(path, "application/json", body.to_string().as_bytes())
    };
    let refused = problem(&asked("/v1/jobs", &body(Some("urgent"))), 422);
    assert_eq!(refused["member"], "priority");
    let jobs = [Some("low"), None, Some("high")].map(|priority| {
        let job = asked("/v1/jobs", &body(priority)).json();
        assert_eq!(job["priority"], priority.unwrap_or("normal"));
        format!("/v1/jobs/{}", job["id"].as_str().unwrap())
    });
    let batch = json!({
        "measurement_ids": [measurement["id"]], "kind": "identify", "priority": "low",
        "plant": {"actuator_order": 0}, "options": {"seed": 5},
    });
    assert_eq!(asked("/v1/batches", &batch).json()["priority"], "low");
    assert_eq!(server.post(&format!("{busy}/cancel"), "text/plain", b"").status, 202);
    let [low, normal, high] = jobs.map(|job| {
        let began = server.ended(&job)["started_at"].as_str().unwrap().to_owned();
        began.parse::<jiff::Timestamp>().unwrap()
    });
    assert!(high < normal && normal < low, "{high}, {normal}, {low}");
}
