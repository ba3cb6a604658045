//! Servers and workers, each a process, on one Postgres.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::durability::{is_running, until};
use crate::postgres_cluster::Cluster;
use crate::process::{Server, command};
use crate::receiver::Receiver;
use crate::service::{endless, submit};
use crate::worker_process::{Worker, server};

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(300);

fn succeeded(server: &Server, job: &str) -> Value {
    let ended = server.ended(job);
    assert_eq!(ended["status"], "succeeded", "{ended}");
    ended
}

#[test]
fn a_worker_counts_what_it_computed_for_whoever_watches_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), &["--workers", "0"]);
    let mut command = command();
    command.args(["worker", "--workers", "1", "--metrics", "127.0.0.1:0", "--data-dir"]);
    let mut child = command.arg(folder.path()).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    let _worker = Worker(child);
    let address = lines.find_map(|line| line.strip_prefix("metrics at ").map(str::to_owned));
    let address = address.expect("it says where");
    succeeded(&server, &submit(&server, &json!({"seed": 5})));
    let ended = "servoscope_jobs_ended_total{kind=\"identify\",outcome=\"succeeded\"} 1";
    // The job has ended a moment before it is counted.
    let began = Instant::now();
    loop {
        let text = ureq::get(&address).call().unwrap().into_body().read_to_string().unwrap();
        if text.lines().any(|line| line == ended) {
            break;
        }
        assert!(began.elapsed() < PATIENCE, "it is not counted in\n{text}");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(!server.get("/metrics").text.contains(ended), "the server computed nothing");
    let root = address.trim_end_matches("metrics");
    assert!(ureq::get(format!("{root}readyz")).call().is_ok());
    assert!(ureq::get(format!("{root}v1/jobs")).call().is_err(), "it serves nothing else");
}

#[test]
fn a_job_is_computed_by_a_worker_and_followed_and_cancelled_from_another_server() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let [first, second] = [server(folder.path(), &database), server(folder.path(), &database)];
    let workers = [Worker::start(&place), Worker::start(&place)];
    let short = submit(&first, &json!({"seed": 5}));
    succeeded(&second, &short);
    let result = format!("{short}/result");
    assert_eq!(first.get(&result).text, second.get(&result).text);

    let long = submit(&first, &endless());
    let stream = ureq::get(format!("{}{long}/events", second.address())).call().unwrap();
    let mut lines = BufReader::new(stream.into_body().into_reader()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("\"running\"")));
    assert!(lines.any(|line| line == "event: convergence"), "rows arrive while it runs");
    assert_eq!(second.post(&format!("{long}/cancel"), "text/plain", b"").status, 202);
    assert!(lines.any(|line| line == "event: end"));
    assert_eq!(first.get(&long).json()["status"], "cancelled");

    let left = submit(&second, &endless());
    until(&first, &left, is_running);
    for worker in workers {
        assert_eq!(worker.terminate(), Some(0));
    }
    let handed_back = first.get(&left).json();
    assert_eq!(handed_back["status"], "queued", "{handed_back}");
}

#[test]
fn whoever_waits_for_a_job_hears_of_its_end_elsewhere_and_reads_nothing_at_the_ends_of_others() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let log = folder.path().join("log");
    let arguments = [&place[..], &["--workers", "0", "-vv"]].concat();
    let asked = Server::start_logging(folder.path(), &arguments, &log);
    let other = server(folder.path(), &database);
    let _workers = [Worker::start(&place), Worker::start(&place)];
    let long = submit(&other, &endless());
    until(&other, &long, is_running);
    let reads = || {
        let log = std::fs::read_to_string(&log).unwrap();
        let read = "summary=\"SELECT id, measurement_id, kind,";
        log.lines().filter(|line| line.contains(read)).count()
    };
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| asked.get(&format!("{long}?wait=60")).json());
        for seed in 0..8 {
            succeeded(&other, &submit(&other, &json!({ "seed": seed })));
        }
        std::thread::sleep(Duration::from_secs(2));
        assert_eq!(reads(), 1, "it is read when it is asked for");
        assert_eq!(other.post(&format!("{long}/cancel"), "text/plain", b"").status, 202);
        assert_eq!(waiting.join().unwrap()["status"], "cancelled");
    });
    assert_eq!(reads(), 2, "and when it has ended");
}

#[test]
fn jobs_of_a_killed_worker_end_once_in_the_hands_of_another() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let [first, second] = [server(folder.path(), &database), server(folder.path(), &database)];
    let receiver = Receiver::start(&["204 No Content"]);
    let hook = json!({"url": receiver.url(), "events": ["job.finished"]}).to_string();
    assert_eq!(first.post("/v1/webhooks", "application/json", hook.as_bytes()).status, 201);

    let killed = Worker::start(&place);
    let mut jobs = vec![submit(&first, &endless())];
    jobs.extend((0..8).map(|seed| submit(&second, &json!({ "seed": seed }))));
    until(&second, &jobs[0], is_running);
    killed.signal(Signal::KILL);
    let _others = [Worker::start(&place), Worker::start(&place)];
    until(&first, &jobs[0], |job| is_running(job) && job["attempt"] == 2);
    for job in &jobs[1..] {
        succeeded(&first, job);
    }
    assert_eq!(first.post(&format!("{}/cancel", jobs[0]), "text/plain", b"").status, 202);
    assert_eq!(second.ended(&jobs[0])["status"], "cancelled");
    let mut told = BTreeMap::new();
    for _ in &jobs {
        let message = receiver.next().json();
        *told.entry(message["data"]["job_id"].as_str().unwrap().to_owned()).or_insert(0) += 1;
    }
    let ids = jobs.iter().map(|job| (job.rsplit('/').next().unwrap().to_owned(), 1));
    assert_eq!(told, ids.collect());
    assert!(receiver.is_untouched(), "each end is told once");
}

#[test]
fn the_late_result_of_a_worker_that_was_stopped_is_refused() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let server = server(folder.path(), &database);
    let log = folder.path().join("log");
    let stopped = Worker::start_logging(&place, File::create(&log).unwrap());
    let job = submit(&server, &endless());
    until(&server, &job, is_running);
    stopped.signal(Signal::STOP);
    let _other = Worker::start(&place);
    until(&server, &job, |job| is_running(job) && job["attempt"] == 2);
    stopped.signal(Signal::CONT);
    let began = Instant::now();
    while !std::fs::read_to_string(&log).unwrap().contains("lease lost; its result is given up") {
        assert!(began.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(20));
    }
    let stands = server.get(&job).json();
    assert_eq!((&stands["status"], &stands["attempt"]), (&"running".into(), &2.into()));
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    assert_eq!(server.ended(&job)["attempt"], 2);
}

#[test]
fn a_worker_takes_jobs_of_a_server_on_the_same_folder() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), &["--workers", "0"]);
    let job = submit(&server, &json!({"seed": 5}));
    assert_eq!(server.get(&job).json()["status"], "queued");
    let worker = Worker::start(&["--data-dir", folder.path().to_str().unwrap()]);
    succeeded(&server, &job);
    assert_eq!(worker.terminate(), Some(0));
}

#[test]
fn a_key_is_made_in_the_database_and_nothing_shows_its_password() {
    let Some(cluster) = Cluster::shared() else { return };
    // Where nobody asks for a password, any will do.
    let database = cluster.database().replace("postgres@", "postgres:secret-kestrel@");
    let mut add = command();
    add.args(["keys", "add", "--name", "first", "--scope", "admin"]);
    let added = add.env("SERVOSCOPE_DATABASE", &database).output().unwrap();
    assert!(added.status.success(), "{added:?}");
    let key = String::from_utf8(added.stdout).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log");
    let arguments = ["--database", database.as_str(), "-vv"];
    let server = Server::start_logging(folder.path(), &arguments, &log);
    assert_eq!(server.get("/v1/jobs").status, 401);
    assert_eq!(server.get_with("/v1/jobs", key.trim()).status, 200);
    assert_eq!(server.terminate(), Some(0));

    let mut show = command();
    let shown = show.args(["config", "show", "--database", &database]).output().unwrap();
    let nowhere = "postgres://bench:secret-kestrel@localhost:1/bench";
    let mut unreachable = command();
    unreachable.args(["worker", "--database", nowhere]);
    let refused = unreachable.output().unwrap();
    assert_eq!(refused.status.code(), Some(1));
    let log = std::fs::read(&log).unwrap();
    for text in [added.stderr, shown.stdout, refused.stdout, refused.stderr, log] {
        let text = String::from_utf8(text).unwrap();
        assert!(!text.contains("kestrel"), "{text}");
    }
}
