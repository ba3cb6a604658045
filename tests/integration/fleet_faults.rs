//! Workers that are killed, and workers whose clocks differ, on one Postgres.

use std::collections::BTreeMap;
use std::time::Duration;

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::durability::{is_running, until};
use crate::postgres_cluster::Cluster;
use crate::process::{Server, simulated};
use crate::receiver::Receiver;
use crate::service::{endless, submit};
use crate::shared_files::skipped;
use crate::worker_process::{LEASE, Worker, server};

/// Jobs that four workers share.
const JOBS: usize = 240;

/// The jobs of one measurement, each with a seed of its own.
fn submitted(server: &Server, count: usize) -> Vec<String> {
    let measurement = server.post("/v1/measurements", "text/csv", &simulated(&[])).json();
    let job = |seed: usize| {
        server.submit(&json!({
            "measurement_id": measurement["id"], "kind": "identify", "method": "least-squares",
            "plant": {"actuator_order": 0}, "options": {"seed": seed},
        }))
    };
    (0..count).map(job).collect()
}

fn ended(server: &Server) -> usize {
    let jobs = server.get("/v1/jobs?status=succeeded&limit=200").json();
    jobs["items"].as_array().unwrap().len()
}

#[test]
fn two_of_four_workers_are_killed_and_hundreds_of_jobs_end_once_each() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let server = server(folder.path(), &database);
    let receiver = Receiver::start(&["204 No Content"]);
    let hook = json!({"url": receiver.url(), "events": ["job.finished"]}).to_string();
    assert_eq!(server.post("/v1/webhooks", "application/json", hook.as_bytes()).status, 201);
    // Two computations that last, so that each of the killed has one in its hands.
    let long = [submit(&server, &endless()), submit(&server, &endless())];
    let killed = [Worker::start(&place), Worker::start(&place)];
    for job in &long {
        until(&server, job, is_running);
    }
    let jobs = submitted(&server, JOBS);
    let _living = [Worker::start(&place), Worker::start(&place)];
    while ended(&server) < JOBS / 8 {
        std::thread::sleep(Duration::from_millis(20));
    }
    for worker in &killed {
        worker.signal(Signal::KILL);
    }
    for job in &long {
        until(&server, job, |job| is_running(job) && job["attempt"] == 2);
        assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
        assert_eq!(server.ended(job)["status"], "cancelled");
    }
    for job in &jobs {
        let ended = server.ended(job);
        assert_eq!((&ended["status"], &ended["attempt"]), (&json!("succeeded"), &json!(1)));
    }
    let all = jobs.iter().chain(&long);
    let mut told: BTreeMap<String, usize> = BTreeMap::new();
    for _ in 0..JOBS + long.len() {
        let message = receiver.next().json();
        *told.entry(message["data"]["job_id"].as_str().unwrap().to_owned()).or_default() += 1;
    }
    let once = all.map(|job| (job.rsplit('/').next().unwrap().to_owned(), 1)).collect();
    assert_eq!(told, once);
    assert!(receiver.is_untouched(), "each end is told once");
}

// Leases are in the time of the database. In that of the workers, the lease of a slow clock would have
// expired when it is taken, and that of a fast one would outlive its worker by an hour.
#[test]
fn workers_whose_clocks_are_an_hour_apart_keep_their_leases_and_lose_them_in_time() {
    let Some(cluster) = Cluster::shared() else { return };
    for offset in ["-3600s", "+3600s"] {
        let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
        let place = ["--database", database.as_str()];
        let server = server(folder.path(), &database);
        let job = submit(&server, &endless());
        let Some(odd) = Worker::with_clock(&place, offset) else {
            let required = std::env::var_os("SERVO_REQUIRE_FAKETIME").is_some();
            assert!(!required, "libfaketime is absent");
            skipped("libfaketime is absent");
            return;
        };
        until(&server, &job, is_running);
        let _right = Worker::start(&place);
        std::thread::sleep(2 * LEASE);
        let kept: Value = server.get(&job).json();
        assert!(is_running(&kept) && kept["attempt"] == 1, "{offset}: {kept}");
        odd.signal(Signal::KILL);
        until(&server, &job, |job| is_running(job) && job["attempt"] == 2);
        assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
        assert_eq!(server.ended(&job)["status"], "cancelled");
    }
}
