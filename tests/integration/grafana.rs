//! The dashboards for Grafana ask for what there is.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::process::{Server, repository, simulated};

fn dashboard(name: &str) -> Value {
    let path = repository("docs/grafana").join(name);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Every object anywhere in a document that has this member.
fn with_member<'a>(value: &'a Value, member: &str, found: &mut Vec<&'a Value>) {
    if value.get(member).is_some() {
        found.push(value);
    }
    let children: Vec<&Value> = match value {
        Value::Object(members) => members.values().collect(),
        Value::Array(items) => items.iter().collect(),
        _ => Vec::new(),
    };
    for child in children {
        with_member(child, member, found);
    }
}

#[test]
fn the_dashboard_of_the_service_names_metrics_that_it_has() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    // A job, so that every family has a member.
    let table = simulated(&["--frequencies-rad-s", "2,10,40", "--noise-db", "60"]);
    let measurement = server.post("/v1/measurements", "text/csv", &table).json()["id"].clone();
    let options = serde_json::json!({"network": {"enabled": false}, "colony": {"cycles": 1}});
    let request = serde_json::json!({
        "measurement_id": measurement, "kind": "identify", "plant": {"actuator_order": 0},
        "options": options,
    });
    assert_eq!(server.ended(&server.submit(&request))["status"], "succeeded");
    let metrics = server.get("/metrics").text;

    let dashboard = dashboard("service.json");
    let mut targets = Vec::new();
    with_member(&dashboard, "expr", &mut targets);
    let mut names = BTreeSet::new();
    for target in targets {
        let expression = target["expr"].as_str().unwrap();
        for part in expression.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            if part.starts_with("servoscope_") {
                names.insert(part);
            }
        }
    }
    assert!(names.len() > 6, "{names:?}");
    for name in names {
        let is_sample =
            |line: &str| line.strip_prefix(name).is_some_and(|rest| rest.starts_with(['{', ' ']));
        assert!(metrics.lines().any(is_sample), "{name} is not in\n{metrics}");
    }
}

#[test]
fn the_dashboard_of_results_asks_for_columns_that_there_are() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let document = server.get("/openapi.json").json();
    let dashboard = dashboard("results.json");
    let mut queries = Vec::new();
    with_member(&dashboard, "root_selector", &mut queries);
    assert!(queries.len() > 6);
    for query in queries {
        let path = query["url"].as_str().unwrap().strip_prefix("${server}").unwrap();
        let operation = &document["paths"][path]["get"];
        assert!(operation.is_object(), "{path} is not served");

        let known = operation["parameters"].as_array().cloned().unwrap_or_default();
        let known: Vec<&str> = known.iter().map(|known| known["name"].as_str().unwrap()).collect();
        for asked in query["url_options"]["params"].as_array().unwrap() {
            let name = asked["key"].as_str().unwrap();
            assert!(known.contains(&name), "{path} does not take {name}");
        }

        let answer = &operation["responses"]["200"]["content"]["application/json"]["schema"];
        let answer = resolved(&document, answer);
        let rows = &answer["properties"][query["root_selector"].as_str().unwrap()]["items"];
        let row = resolved(&document, rows);
        for column in query["columns"].as_array().unwrap() {
            let name = column["selector"].as_str().unwrap();
            assert!(row["properties"][name].is_object(), "{path} has no {name}: {row}");
        }
    }
}

/// A schema, or what it refers to.
fn resolved<'a>(document: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(reference) => document.pointer(reference.trim_start_matches('#')).unwrap(),
        None => schema,
    }
}
