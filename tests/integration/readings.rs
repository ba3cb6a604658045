//! Stored files read again in other units, until there is a job on them.

use serde_json::{Value, json};

use crate::process::{Server, simulated};
use crate::service::problem;

/// A server with one measurement, a velocity in rad/s, and its path.
fn measured() -> (Server, String, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let table = simulated(&["--harmonics", "1", "--frequency-range", "1:20:5"]);
    let query = "/v1/measurements?input=current%20A&response=velocity%20rad/s";
    let answer = server.post(query, "text/csv", &table);
    assert_eq!(answer.status, 201, "{}", answer.text);
    let path = format!("/v1/measurements/{}", answer.json()["id"].as_str().unwrap());
    (server, path, directory)
}

fn previewed(server: &Server, path: &str, body: &Value) -> Value {
    let bytes = body.to_string();
    let answer = server.post(&format!("{path}/preview"), "application/json", bytes.as_bytes());
    assert_eq!(answer.status, 200, "{}", answer.text);
    answer.json()
}

#[test]
fn a_response_becomes_a_position_and_everything_follows() {
    let (server, path, _directory) = measured();
    let described = json!({"machine": "press 4"}).to_string();
    assert_eq!(server.patch_bytes(&path, "application/json", described.as_bytes()), 200);
    let before = server.get(&path).json();
    let given = previewed(&server, &path, &json!({}))["given"].clone();
    assert_eq!(given, json!({"input": "current A", "response": "velocity rad/s"}));

    let other = json!({"given": {"input": "force N", "response": "position mm"}});
    let seen = previewed(&server, &path, &other);
    assert_eq!(seen["measurement"]["response"], json!({"name": "position", "unit": "mm"}));
    assert_eq!(server.get(&path).json(), before, "a preview stores nothing");
    let answer = server.put(&format!("{path}/reading"), &other);
    assert_eq!(answer.status, 200, "{}", answer.text);
    let after = server.get(&path).json();
    assert_eq!(answer.json(), after);
    assert_eq!(after["response_kind"], "position");
    assert_eq!(after["input"], json!({"name": "force", "unit": "N"}));
    assert_eq!(after["machine"], "press 4", "what it says of itself stays");
    assert_eq!(after["files"], before["files"]);
    assert_ne!(after["sha256"], before["sha256"]);
    assert!(server.get(&format!("{path}/data.csv")).text.contains("# response: position mm"));
    assert_eq!(previewed(&server, &path, &json!({}))["given"], other["given"]);
}

#[test]
fn a_reading_that_fails_or_that_results_stand_on_changes_nothing() {
    let (server, path, _directory) = measured();
    let before = server.get(&path).json();
    let reading = format!("{path}/reading");
    let put = |given: Value| server.put(&reading, &json!({ "given": given }));
    let refused = problem(&put(json!({"loop": "sideways"})), 422);
    assert_eq!(refused["type"], "urn:servoscope:problem:unreadable-measurement", "{refused}");
    let refused = problem(&put(json!({"machine": "press 5"})), 422);
    assert_eq!(refused["member"], "given.machine");
    assert_eq!(server.get(&path).json(), before);

    let id = before["id"].as_str().unwrap();
    let plant = json!({"actuator_order": 0});
    let job = server.submit(&json!({"measurement_id": id, "kind": "identify", "plant": plant}));
    let refused = problem(&put(json!({"response": "position mm"})), 409);
    assert_eq!(refused["type"], "urn:servoscope:problem:has-jobs");
    assert_eq!(server.get(&path).json(), before);
    server.ended(&job);
    assert_eq!(server.delete(&job), 204);
    assert_eq!(put(json!({"response": "position mm"})).status, 200);
}
