//! Postgres restarted while callers upload, jobs are queued and workers compute.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Stdio;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;
use sqlx::Connection as _;

use crate::postgres_cluster::Cluster;
use crate::process::{Server, command, simulated};
use crate::receiver::Receiver;
use crate::service::{items, problem};
use crate::worker_process::{Worker, server};

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(300);

const CALLERS: usize = 3;

/// Between two uploads of a caller, so that workers keep up.
const PAUSE: Duration = Duration::from_millis(200);

/// Lets callers end when it is dropped, also by a test that fails.
struct Going<'a>(&'a AtomicBool);

impl Drop for Going<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::SeqCst);
    }
}

/// A worker that is not late for its lease on a machine that is busy.
fn worker(database: &str) -> Worker {
    let mut worker = command();
    worker.args(["worker", "--workers", "1", "--database", database]);
    worker.args(["--lease-seconds", "8", "--retry-seconds", "0"]);
    Worker(worker.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
}

/// Sends the same request until it is accepted: meanwhile only the database may be out of reach.
fn accepted(server: &Server, path: &str, kind: &str, key: &str, body: &[u8]) -> String {
    let began = Instant::now();
    loop {
        let headers = [("content-type", kind), ("idempotency-key", key)];
        let answer = server.post_with(path, &headers, body);
        if [200, 201, 202].contains(&answer.status) {
            return answer.json()["id"].as_str().unwrap().to_owned();
        }
        problem(&answer, 503);
        assert!(began.elapsed() < PATIENCE, "{key} is not accepted");
        std::thread::sleep(PAUSE);
    }
}

/// Uploads measurements and queues a job for each, for as long as it should.
fn call(server: &Server, caller: usize, going: &AtomicBool, done: &Mutex<Vec<[String; 2]>>) {
    let table = simulated(&[]);
    for place in 0.. {
        if !going.load(Ordering::SeqCst) {
            return;
        }
        let key = format!("{caller}-{place}");
        let measurement = accepted(server, "/v1/measurements", "text/csv", &key, &table);
        let request = json!({
            "measurement_id": measurement, "kind": "identify", "method": "least-squares",
            "plant": {"actuator_order": 0}, "options": {"seed": place},
        });
        let request = request.to_string();
        let job = accepted(server, "/v1/jobs", "application/json", &key, request.as_bytes());
        done.lock().unwrap().push([measurement, job]);
        std::thread::sleep(PAUSE);
    }
}

/// How many jobs have ended, where the database is there to say so.
fn ended(server: &Server) -> usize {
    let answer = server.get("/v1/jobs?status=succeeded&limit=200");
    if answer.status == 200 {
        return answer.json()["items"].as_array().unwrap().len();
    }
    problem(&answer, 503);
    0
}

/// Attempts of which any job was charged.
fn charged(database: &str) -> i64 {
    tokio::runtime::Runtime::new().unwrap().block_on(async {
        let mut connection = sqlx::PgConnection::connect(database).await.unwrap();
        let all = sqlx::query_scalar("SELECT sum(charged)::bigint FROM jobs");
        all.fetch_one(&mut connection).await.unwrap()
    })
}

#[test]
fn callers_and_workers_go_on_through_restarts_of_postgres_and_each_job_ends_once_and_uncharged() {
    let Some(cluster) = Cluster::alone() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let server = server(folder.path(), &database);
    let receiver = Receiver::start(&["204 No Content"]);
    let hook = json!({"url": receiver.url(), "events": ["job.finished"]}).to_string();
    assert_eq!(server.post("/v1/webhooks", "application/json", hook.as_bytes()).status, 201);
    let _workers = [worker(&database), worker(&database)];

    let (going, done) = (AtomicBool::new(true), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        let callers: Vec<_> = (0..CALLERS)
            .map(|caller| {
                scope.spawn({
                    let (server, going, done) = (&server, &going, &done);
                    move || call(server, caller, going, done)
                })
            })
            .collect();
        let until_here = Going(&going);
        let more = || {
            let began = Instant::now();
            let [accepted, computed] = [done.lock().unwrap().len(), ended(&server)];
            // A page shows 200 of the jobs that have ended.
            let enough = (computed + 4).min(200);
            while done.lock().unwrap().len() < accepted + 2 * CALLERS || ended(&server) < enough {
                let failed = callers.iter().any(|caller| caller.is_finished());
                if failed || began.elapsed() > PATIENCE {
                    return false;
                }
                std::thread::sleep(Duration::from_millis(50));
            }
            true
        };
        let went_on = (0..3).all(|restart| {
            if restart > 0 {
                cluster.stop();
                assert_eq!(server.get("/livez").status, 200);
                // Long enough for each caller to have met a database that is away.
                std::thread::sleep(2 * PAUSE);
                cluster.start_again();
            }
            more()
        });
        drop(until_here);
        assert!(went_on, "uploads and jobs go on after each restart");
    });

    let done = done.into_inner().unwrap();
    for [_, job] in &done {
        let ended = server.ended(&format!("/v1/jobs/{job}"));
        assert_eq!(ended["status"], "succeeded", "{ended}");
        assert_eq!(server.get(&format!("/v1/jobs/{job}/result")).status, 200);
    }
    for (list, place) in [("/v1/measurements", 0), ("/v1/jobs", 1)] {
        let stored = items(&server, list);
        assert_eq!(stored.len(), done.len(), "each is stored once");
        let stored: BTreeSet<&str> =
            stored.iter().map(|item| item["id"].as_str().unwrap()).collect();
        assert_eq!(stored, done.iter().map(|ids| ids[place].as_str()).collect());
    }
    assert_eq!(charged(&database), 0);
    // A message may come twice where it was not stored that it had come; an end has one message.
    let mut told: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    while told.len() < done.len() {
        let message = receiver.next();
        let job = message.json()["data"]["job_id"].as_str().unwrap().to_owned();
        told.entry(job).or_default().insert(message.header("webhook-id").to_owned());
    }
    assert!(told.values().all(|messages| messages.len() == 1), "{told:?}");
}
