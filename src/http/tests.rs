//! The service over HTTP with a scripted computation behind it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::http::HeaderValue;
use serde_json::{Value, json};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use ureq::http::Response;
use ureq::{Agent, Body};

use crate::notify::{Allowed, Webhooks};
use crate::service::testing::{INCOMPARABLE, RUN_UNTIL_CANCELLED, SUCCEED, Scripted, UNUSABLE};
use crate::service::{NewKey, Outlets, Quotas, Scope, Service, Signals};
use crate::store::{Sqlite, Store};
use crate::worker;

use super::{Callers, Keeping, Limits, Pace};

mod axes;
mod batches;
mod bodies;
mod connections;
mod dashboard;
mod documents;
mod events;
mod failures;
mod inspections;
mod jobs;
mod keys;
mod lists;
mod operations;
mod plans;
mod problems;
mod quotas;
mod rules;
mod scopes;
mod sessions;
mod uploads;

/// Bytes that an upload may have here.
const LIMIT: usize = 10_000;

/// Bytes that the bodies of all requests may have together here: of small pieces there are 64.
const BODIES: usize = 1 << 20;

struct Server {
    address: String,
    agent: Agent,
    signals: Arc<Signals>,
    service: Service,
    store: Arc<dyn Store>,
    runtime: Runtime,
    directory: tempfile::TempDir,
}

impl Server {
    fn start() -> Self {
        Self::start_for(Vec::new())
    }

    fn start_for(origins: Vec<HeaderValue>) -> Self {
        Self::start_keeping(origins, Keeping::new(100))
    }

    fn start_keeping(origins: Vec<HeaderValue>, keeping: Keeping) -> Self {
        Self::start_with(origins, keeping, Quotas::default())
    }

    /// A server that holds each key to quotas.
    fn start_with(origins: Vec<HeaderValue>, keeping: Keeping, quotas: Quotas) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let runtime = Runtime::new().unwrap();
        let signals = Arc::new(Signals::default());
        let store: Arc<dyn Store> =
            Arc::new(runtime.block_on(Sqlite::open(directory.path())).unwrap());
        let service = Service::new(Arc::clone(&store), Arc::new(Scripted), Arc::clone(&signals));
        // Nobody listens there.
        let here = Allowed::new(vec!["127.0.0.0/8".parse().unwrap()]);
        let outlets = Outlets { webhooks: Webhooks::new(here), broker: None };
        let service = service.telling(outlets).within(quotas);
        let address = runtime.block_on(async {
            let settings = worker::Settings::new(2);
            worker::start(Arc::clone(&store), service.clone(), Arc::clone(&signals), settings);
            let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
            let address = listener.local_addr().unwrap();
            let callers = Callers { origins, ..Callers::default() };
            let (sent_bytes, unpacked_bytes, pace) = (LIMIT, LIMIT, Pace::default());
            let app = super::app(
                service.clone(),
                Limits {
                    sent_bytes,
                    unpacked_bytes,
                    bodies_bytes: BODIES,
                    pace,
                    callers,
                    keys_always: false,
                },
            );
            let counts = service.metrics().connections().clone();
            tokio::spawn(super::serve(listener, app, keeping, Arc::clone(&signals), counts));
            format!("http://{address}")
        });
        let agent = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(Duration::from_secs(60)))
            .build()
            .into();
        Self { address, agent, signals, service, store, runtime, directory }
    }

    /// A new key with these scopes: its id, and the whole of it.
    fn key(&self, scopes: &[Scope]) -> (String, String) {
        let new = NewKey {
            name: "rig".into(),
            scopes: scopes.to_vec(),
            expires_at_ms: None,
            quotas: Quotas::default(),
        };
        let (key, token) = self.runtime.block_on(self.service.add_key(new)).unwrap();
        (key.id, token.text())
    }

    /// Changes the database behind the server's back.
    fn database(&self, statement: &'static str) {
        use sqlx::Connection as _;

        let file = self.directory.path().join("servoscope.sqlite3");
        self.runtime.block_on(async {
            let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file);
            let mut connection = sqlx::SqliteConnection::connect_with(&options).await.unwrap();
            sqlx::raw_sql(statement).execute(&mut connection).await.unwrap();
        });
    }

    /// Sends a request as it stands.
    fn send(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Response<Body> {
        let request = ureq::http::Request::builder().method(method);
        let request = request.uri(format!("{}{path}", self.address));
        let request =
            headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        if body.is_empty() && ["GET", "DELETE"].contains(&method) {
            return self.agent.run(request.body(()).unwrap()).unwrap();
        }
        self.agent.run(request.body(body.to_vec()).unwrap()).unwrap()
    }

    fn get(&self, path: &str) -> Response<Body> {
        self.agent.get(format!("{}{path}", self.address)).call().unwrap()
    }

    fn post(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Response<Body> {
        let request = self.agent.post(format!("{}{path}", self.address));
        let request =
            headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        request.send(body).unwrap()
    }

    fn patch(&self, path: &str, body: &Value) -> Response<Body> {
        let request = self.agent.patch(format!("{}{path}", self.address));
        request.header("content-type", "application/json").send(body.to_string()).unwrap()
    }

    fn delete(&self, path: &str) -> u16 {
        self.agent.delete(format!("{}{path}", self.address)).call().unwrap().status().as_u16()
    }

    fn measurement(&self) -> String {
        let answer = self.post("/v1/measurements", &[("content-type", "text/csv")], b"any");
        string(&json_of(answer, 201), "id")
    }

    fn submit(&self, body: &Value) -> Response<Body> {
        let body = body.to_string();
        self.post("/v1/jobs", &[("content-type", "application/json")], body.as_bytes())
    }

    fn job(&self, seed: u64) -> String {
        let body = json!({
            "measurement_id": self.measurement(), "kind": "identify", "options": {"seed": seed},
        });
        string(&json_of(self.submit(&body), 202), "id")
    }

    fn ended(&self, id: &str) -> Value {
        json_of(self.get(&format!("/v1/jobs/{id}?wait=60")), 200)
    }
}

fn header<'a>(answer: &'a Response<Body>, name: &str) -> &'a str {
    answer.headers().get(name).map_or("", |value| value.to_str().unwrap())
}

fn json_of(mut answer: Response<Body>, status: u16) -> Value {
    let text = answer.body_mut().read_to_string().unwrap();
    assert_eq!(answer.status(), status, "{text}");
    serde_json::from_str(&text).unwrap()
}

/// The problem document of an answer, checked for what every one has.
fn problem(answer: Response<Body>, status: u16) -> Value {
    assert_eq!(header(&answer, "content-type"), "application/problem+json");
    assert_ne!(header(&answer, "x-request-id"), "");
    let problem = json_of(answer, status);
    assert_eq!(problem["status"], status);
    assert!(problem["title"].is_string() && problem["type"].is_string(), "{problem}");
    assert_ne!(string(&problem, "detail"), "");
    problem
}

fn string(value: &Value, member: &str) -> String {
    value[member].as_str().unwrap_or_else(|| panic!("no text `{member}` in {value}")).to_owned()
}

#[test]
fn lists_are_paged_by_a_cursor() {
    let server = Server::start();
    let mut ids = [server.measurement(), server.measurement(), server.measurement()];
    ids.reverse();
    let first = json_of(server.get("/v1/measurements?limit=2&machine=press%204"), 200);
    let second =
        json_of(server.get(&format!("/v1/measurements?cursor={}", string(&first, "next"))), 200);
    let listed = [&first["items"][0], &first["items"][1], &second["items"][0]];
    assert_eq!(listed.map(|item| string(item, "id")), ids);
    assert_eq!(second["next"], Value::Null);
}

#[test]
fn the_service_describes_itself() {
    let server = Server::start();
    assert_eq!(server.get("/livez").status(), 200);
    assert_eq!(server.get("/readyz").status(), 200);
    let document = json_of(server.get("/openapi.json"), 200);
    let paths = document["paths"].as_object().unwrap();
    assert!(paths["/v1/jobs"]["post"].is_object());
    let operations = paths.values().flat_map(|item| item.as_object().unwrap().values());
    let ids = operations.map(|operation| string(operation, "operationId")).collect::<Vec<_>>();
    let unique = ids.iter().collect::<std::collections::BTreeSet<_>>();
    assert_eq!(unique.len(), ids.len(), "each operation needs an id of its own: {ids:?}");
}
