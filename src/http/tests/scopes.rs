//! Every operation of the document, asked with every scope and none, for data of another key.

use super::*;
use crate::http::access::{Need, need};

/// An operation as the document has it.
struct Operation {
    id: String,
    method: String,
    path: String,
}

fn operations() -> Vec<Operation> {
    let document = serde_json::to_value(crate::http::openapi()).unwrap();
    let paths = document["paths"].as_object().unwrap();
    let all = paths.iter().flat_map(|(path, item)| {
        item.as_object().unwrap().iter().map(move |(method, operation)| Operation {
            id: string(operation, "operationId"),
            method: method.to_uppercase(),
            path: path.clone(),
        })
    });
    all.collect()
}

/// What one key has made: something of every kind.
struct Things {
    measurement: String,
    job: String,
    batch: String,
    mapping: String,
    webhook: String,
    key: String,
}

/// A word in the settings of every mapping that is made.
const SETTING: &str = "a bench in the cellar";

impl Things {
    fn of(server: &Server, key: &str, operation: &Operation) -> Self {
        let json = |method: &str, path: &str, body: Value, status: u16| {
            let body = if method == "GET" { String::new() } else { body.to_string() };
            let headers = [bearer(key), ("content-type", "application/json".to_owned())];
            json_of(ask(server, method, path, &headers, body.as_bytes()), status)
        };
        let headers = [bearer(key), ("content-type", "text/csv".to_owned())];
        let measurement = json_of(ask(server, "POST", "/v1/measurements", &headers, b"any"), 201);
        let measurement = string(&measurement, "id");
        let seed = if operation.id == "cancel_job" { RUN_UNTIL_CANCELLED } else { SUCCEED };
        let body = json!({
            "measurement_id": measurement, "kind": "identify", "options": {"seed": seed},
        });
        let job = string(&json("POST", "/v1/jobs", body, 202), "id");
        if seed == SUCCEED {
            let path = format!("/v1/jobs/{job}?wait=60");
            assert_eq!(json("GET", &path, json!({}), 200)["status"], "succeeded");
        }
        let batch = match operation.path.contains("batches") {
            true => {
                let body = json!({"measurement_ids": [measurement], "kind": "identify"});
                string(&json("POST", "/v1/batches", body, 202), "id")
            }
            false => "no batch was made".to_owned(),
        };
        let mapping = format!("mapping of {measurement}");
        let body = json!({"settings": {"machine": SETTING}});
        json("PUT", &format!("/v1/mappings/{}", mapping.replace(' ', "%20")), body, 201);
        let webhook = match operation.path.contains("webhooks") {
            true => {
                let body = json!({"url": "http://127.0.0.1:9/"});
                string(&json("POST", "/v1/webhooks", body, 201), "id")
            }
            false => "no webhook was made".to_owned(),
        };
        Self { measurement, job, batch, mapping, webhook, key: server.key(&[Scope::Read]).0 }
    }

    /// The path of an operation on them.
    fn path(&self, operation: &Operation) -> String {
        let path = &operation.path;
        let id = match path.split('/').nth(2) {
            Some("jobs") => &self.job,
            Some("batches") => &self.batch,
            Some("webhooks") => &self.webhook,
            Some("keys") => &self.key,
            _ => &self.measurement,
        };
        let name = self.mapping.replace(' ', "%20");
        let path = path.replace("{id}", id).replace("{name}", &name);
        let path = path.replace("{file}", "friction.svg");
        match operation.id.as_str() {
            "get_history" | "get_history_csv" | "get_history_figure" => {
                format!("{path}?machine=press%204&axis=x")
            }
            _ => path,
        }
    }

    /// The body of an operation on them, and its type.
    fn body(&self, operation: &Operation, key: &str) -> (Vec<u8>, &'static str) {
        let body = match operation.id.as_str() {
            "add_measurement" | "preview_measurement" => return (b"any".to_vec(), "text/csv"),
            "submit_job" => json!({"measurement_id": self.measurement, "kind": "identify"}),
            "submit_batch" => json!({"measurement_ids": [self.measurement], "kind": "identify"}),
            "validate" => json!({"job_id": self.job, "measurement_id": self.measurement}),
            "plan" | "plan_excitation" | "plan_figure" => {
                json!({"job_id": self.job, "budget_s": 80.0})
            }
            "describe_measurement" => json!({"name": "another"}),
            "read_again" | "preview_reading" => json!({"given": {"response": "velocity rad/s"}}),
            "put_mapping" => json!({"settings": {"machine": "mine"}}),
            "add_webhook" => json!({"url": "http://127.0.0.1:9/"}),
            "add_key" => json!({"name": "another", "scopes": ["read"]}),
            "limit_key" => json!({"jobs": 5}),
            "sign_in" => json!({"key": key}),
            _ => return (Vec::new(), "application/json"),
        };
        (body.to_string().into_bytes(), "application/json")
    }
}

fn bearer(key: &str) -> (&'static str, String) {
    ("authorization", format!("Bearer {key}"))
}

fn ask(
    server: &Server,
    method: &str,
    path: &str,
    headers: &[(&'static str, String)],
    body: &[u8],
) -> Response<Body> {
    let headers: Vec<(&str, &str)> =
        headers.iter().map(|(n, value)| (*n, value.as_str())).collect();
    server.send(method, path, &headers, body)
}

/// Asks for an operation on things with a key.
fn answer(
    server: &Server,
    operation: &Operation,
    things: &Things,
    key: Option<&str>,
) -> Response<Body> {
    let (body, media_type) = things.body(operation, key.unwrap_or("none"));
    let mut headers: Vec<(&'static str, String)> = key.map(bearer).into_iter().collect();
    headers.push(("content-type", media_type.to_owned()));
    ask(server, &operation.method, &things.path(operation), &headers, &body)
}

const WITHOUT_ADMIN: [Scope; 4] = [Scope::Upload, Scope::Run, Scope::Read, Scope::Metrics];

#[test]
fn every_operation_asks_for_its_scope_and_nothing_else() {
    let server = Server::start();
    let (_, owner) = server.key(&WITHOUT_ADMIN);
    let keys = Scope::ALL.map(|scope| (scope, server.key(&[scope]).1));
    for operation in operations() {
        let things = Things::of(&server, &owner, &operation);
        let need = need(&operation.id).unwrap_or_else(|| panic!("{}: no scope", operation.id));
        let nobody = answer(&server, &operation, &things, None);
        match need {
            // A key that is wrong is refused there, too.
            Need::Nothing if operation.id == "sign_in" => drop(problem(nobody, 401)),
            Need::Nothing => assert_eq!(nobody.status(), 200, "{}", operation.id),
            Need::Key | Need::Scope(_) => {
                assert_eq!(header(&nobody, "www-authenticate"), "Bearer realm=\"servoscope\"");
                let refused = problem(nobody, 401);
                assert!(string(&refused, "detail").contains("servoscope keys add"), "{refused}");
            }
        }
        for (scope, key) in &keys {
            let answer = answer(&server, &operation, &things, Some(key));
            let enough = match need {
                Need::Nothing | Need::Key => true,
                Need::Scope(needed) => {
                    let reads = needed == Scope::Read && *scope == Scope::ReadAll;
                    reads || needed == *scope || *scope == Scope::Admin
                }
            };
            if enough {
                let status = answer.status().as_u16();
                assert!(![401, 403].contains(&status), "{} with {scope}: {status}", operation.id);
            } else {
                let refused = problem(answer, 403);
                let Need::Scope(needed) = need else { unreachable!() };
                assert_eq!(refused["type"], "urn:servoscope:problem:missing-scope");
                let lacks = format!("lacks the scope `{needed}`; it has `{scope}`");
                assert!(string(&refused, "detail").contains(&lacks), "{}: {refused}", operation.id);
            }
        }
    }
}

/// The status of an answer. A plan that is refused since the scripted result tells too little of
/// its axis has found the result, and another reading that is refused since there is a job has found
/// the measurement.
fn outcome(operation: &Operation, answer: &Response<Body>) -> u16 {
    match answer.status().as_u16() {
        422 if operation.id.starts_with("plan") => 200,
        409 if operation.id == "read_again" => 200,
        status => status,
    }
}

fn answer_of_owner(server: &Server, operation: &Operation, things: &Things, owner: &str) {
    let status = outcome(operation, &answer(server, operation, things, Some(owner)));
    let expected = match (need(&operation.id), operation.id.as_str()) {
        (Some(Need::Scope(Scope::Admin)), _) => 403..404,
        _ => 200..300,
    };
    assert!(expected.contains(&status), "{} of its owner: {status}", operation.id);
}

#[test]
fn what_a_key_has_made_is_there_for_it_and_for_admins_alone() {
    let server = Server::start();
    let (_, owner) = server.key(&WITHOUT_ADMIN);
    let (_, stranger) = server.key(&WITHOUT_ADMIN);
    let (_, reader) = server.key(&[Scope::Upload, Scope::Run, Scope::ReadAll, Scope::Metrics]);
    let (_, admin) = server.key(&[Scope::Admin]);
    for operation in operations() {
        let id = operation.id.as_str();
        let fresh = || Things::of(&server, &owner, &operation);
        let needs_admin = need(id) == Some(Need::Scope(Scope::Admin));
        let reads = need(id) == Some(Need::Scope(Scope::Read));
        // Those that name a thing of another key, in the path or in the body.
        let names = operation.path.contains("{") && id != "put_mapping";
        let uses = names
            || matches!(id, "submit_job" | "submit_batch" | "validate")
            || id.starts_with("plan");

        let things = fresh();
        let mut strange = answer(&server, &operation, &things, Some(&stranger));
        let code = strange.status().as_u16();
        let expected = match (needs_admin, uses || id == "get_history_figure") {
            (true, _) => 403,
            (false, true) => 404,
            (false, false) => 200,
        };
        assert!(
            code == expected || (expected == 200 && code / 100 == 2),
            "{id} of a stranger: {code}, not {expected}"
        );
        if code < 300 {
            let text = strange.body_mut().read_to_string().unwrap();
            // What it makes itself is of a machine, or has a name, that is the same; the document
            // has examples.
            let own = ["add_measurement", "preview_measurement", "put_mapping", "openapi_document"]
                .contains(&id);
            let Things { measurement, job, batch, mapping, webhook, .. } = &things;
            for secret in [measurement, job, batch, mapping, webhook, SETTING, "press 4"] {
                assert!(own || !text.contains(secret), "{id} shows a stranger {secret}: {text}");
            }
        }
        // What the stranger has made must not be seen as the owner's below.
        forget_all(&server, &stranger);
        answer_of_owner(&server, &operation, &things, &owner);

        let things = fresh();
        let status = outcome(&operation, &answer(&server, &operation, &things, Some(&reader)));
        let expected = match (needs_admin, names && !reads) {
            (true, _) => 403..404,
            (false, true) => 404..405,
            (false, false) => 200..300,
        };
        assert!(expected.contains(&status), "{id} of one that reads all: {status}");

        let things = fresh();
        let status = outcome(&operation, &answer(&server, &operation, &things, Some(&admin)));
        assert!((200..300).contains(&status), "{id} of an admin: {status}");
        forget_all(&server, &owner);
    }
}

/// Deletes what a key has made, so that nothing of it runs on or is listed.
fn forget_all(server: &Server, key: &str) {
    let lists =
        [("batches", "id"), ("measurements", "id"), ("webhooks", "id"), ("mappings", "name")];
    for (list, name) in lists {
        let listed = json_of(ask(server, "GET", &format!("/v1/{list}"), &[bearer(key)], b""), 200);
        for item in listed["items"].as_array().unwrap() {
            let path = format!("/v1/{list}/{}", string(item, name).replace(' ', "%20"));
            assert_eq!(ask(server, "DELETE", &path, &[bearer(key)], b"").status(), 204, "{path}");
        }
    }
}
