//! Batches on servers and workers, each a process, and from the command line.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::postgres_cluster::Cluster;
use crate::process::{Server, command, simulated};
use crate::receiver::Receiver;
use crate::service::endless;
use crate::worker_process::{QUICK, Worker, server};

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(300);

/// Jobs of a batch that is interrupted.
const JOBS: usize = 36;

/// Uploads a measurement so many times, and makes a batch of them, whose path it gives.
fn batch(server: &Server, count: usize, options: &Value) -> String {
    let table = simulated(&[]);
    let ids: Vec<Value> = (0..count)
        .map(|place| {
            let path = format!("/v1/measurements?name=run-{place}.csv");
            let measurement = server.post(&path, "text/csv", &table);
            assert_eq!(measurement.status, 201, "{}", measurement.text);
            measurement.json()["id"].clone()
        })
        .collect();
    let body = json!({
        "kind": "identify", "measurement_ids": ids, "plant": {"actuator_order": 0},
        "options": options,
    });
    let made = server.post("/v1/batches", "application/json", body.to_string().as_bytes());
    assert_eq!(made.status, 202, "{}", made.text);
    format!("/v1/batches/{}", made.json()["id"].as_str().unwrap())
}

/// Waits until a batch says what is wanted of it.
pub fn until(server: &Server, batch: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let now = server.get(batch).json();
        if wanted(&now) {
            return now;
        }
        assert!(began.elapsed() < PATIENCE, "it stays at {now}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

pub fn count(batch: &Value, state: &str) -> usize {
    usize::try_from(batch["counts"][state].as_i64().unwrap()).unwrap()
}

/// Some of its jobs have ended, and some wait.
fn is_in_the_middle(batch: &Value) -> bool {
    count(batch, "succeeded") >= 3 && count(batch, "queued") >= 3
}

pub fn has_ended(batch: &Value) -> bool {
    batch["state"] == "ended"
}

fn told_ends(server: &Server) -> Receiver {
    let receiver = Receiver::start(&["204 No Content"]);
    let hook = json!({"url": receiver.url(), "events": ["job.finished"]}).to_string();
    assert_eq!(server.post("/v1/webhooks", "application/json", hook.as_bytes()).status, 201);
    receiver
}

/// Every job of a batch has succeeded, and its end was told once.
fn each_finished_once(server: &Server, batch: &str, receiver: &Receiver) {
    let ended = until(server, batch, has_ended);
    assert_eq!((count(&ended, "succeeded"), &ended["jobs"]), (JOBS, &JOBS.into()), "{ended}");
    let rows = server.get(&format!("{batch}/results?limit=200")).json();
    let rows = rows["items"].as_array().unwrap();
    let ids = rows.iter().map(|row| (row["job_id"].as_str().unwrap().to_owned(), 1));
    let ids: BTreeMap<String, i32> = ids.collect();
    assert_eq!(ids.len(), JOBS);
    for (place, row) in rows.iter().enumerate() {
        assert_eq!(
            (&row["file"], &row["state"]),
            (&json!(format!("run-{place}.csv")), &json!("succeeded"))
        );
    }
    let mut told = BTreeMap::new();
    for _ in 0..JOBS {
        let message = receiver.next().json();
        *told.entry(message["data"]["job_id"].as_str().unwrap().to_owned()).or_insert(0) += 1;
    }
    assert_eq!(told, ids);
    assert!(receiver.is_untouched(), "each end is told once");
}

#[test]
fn a_batch_is_finished_by_the_next_server_and_each_job_once_when_a_server_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let start = || {
        let here = ["--workers", "2", "--webhook-allow", "127.0.0.0/8"];
        Server::start(folder.path(), &[&here[..], &QUICK].concat())
    };
    let server = start();
    let receiver = told_ends(&server);
    let batch = batch(&server, JOBS, &json!({}));
    until(&server, &batch, is_in_the_middle);
    server.kill();
    let server = start();
    each_finished_once(&server, &batch, &receiver);
}

#[test]
fn workers_share_a_batch_and_one_that_is_killed_is_made_up_for() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let place = ["--database", database.as_str()];
    let server = server(folder.path(), &database);
    let receiver = told_ends(&server);
    let killed = Worker::start(&place);
    let batch = batch(&server, JOBS, &json!({}));
    until(&server, &batch, is_in_the_middle);
    killed.signal(Signal::KILL);
    let _others = [Worker::start(&place), Worker::start(&place)];
    each_finished_once(&server, &batch, &receiver);
}

/// A folder with measurements, and one file that is none.
fn measurements(folder: &Path) -> String {
    std::fs::create_dir(folder).unwrap();
    for seed in ["1", "2", "3"] {
        let table = simulated(&["--noise-db", "60", "--seed", seed]);
        std::fs::write(folder.join(format!("run-{seed}.csv")), table).unwrap();
    }
    std::fs::write(folder.join("notes.txt"), "the belt was loose").unwrap();
    std::fs::write(folder.join("video.mp4"), vec![b'x'; 2 << 20]).unwrap();
    folder.to_str().unwrap().to_owned()
}

fn start(server: &Server, arguments: &[&str]) -> Child {
    let mut command = command();
    command.args(["batch", "--server", server.address()]).args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

fn run(server: &Server, arguments: &[&str]) -> Output {
    start(server, arguments).wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn listed(server: &Server, list: &str) -> Vec<Value> {
    server.get(&format!("/v1/{list}?limit=200")).json()["items"].as_array().unwrap().clone()
}

#[test]
fn a_folder_is_computed_once_however_often_it_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(&directory.path().join("data"), &["--max-upload-mib", "1"]);
    let folder = measurements(&directory.path().join("press hall"));
    let arguments = [folder.as_str(), "--kind", "identify", "--actuator-order", "0"];
    let first = run(&server, &arguments);
    let (out, said) = (text(&first.stdout), text(&first.stderr));
    assert!(first.status.success(), "{out}{said}");
    assert!(said.contains("notes.txt: not read: "), "{said}");
    assert!(said.contains("video.mp4: not read: the body is larger than"), "{said}");
    assert!(said.contains("3 of 3 ended"), "{said}");
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].starts_with("file       state "), "{out}");
    for (line, seed) in lines[1..].iter().zip(1..=3) {
        assert!(line.starts_with(&format!("run-{seed}.csv  succeeded")), "{out}");
    }
    assert!(out.contains("\n3 of 3 ended: 3 succeeded\n"), "{out}");

    let again = run(&server, &arguments);
    assert_eq!(text(&again.stdout), out);
    let kept = [("measurements", 3), ("jobs", 3), ("batches", 1)];
    for (list, count) in kept {
        assert_eq!(listed(&server, list).len(), count, "{list}");
    }
    let batch = &listed(&server, "batches")[0];
    assert_eq!((&batch["name"], &batch["jobs"]), (&json!("press hall"), &json!(3)));
    let id = batch["id"].as_str().unwrap();
    assert_eq!(text(&run(&server, &["--resume", id]).stdout), out);
    // Another question is another batch of the same measurements.
    let other = run(&server, &[&arguments[..], &["--options", "{\"seed\": 7}"]].concat());
    assert!(other.status.success(), "{}", text(&other.stderr));
    for (list, count) in [("measurements", 3), ("jobs", 6), ("batches", 2)] {
        assert_eq!(listed(&server, list).len(), count, "{list}");
    }
}

#[test]
fn an_interrupt_leaves_a_batch_running_and_says_how_to_take_it_up() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(&directory.path().join("data"), &["--workers", "1"]);
    let folder = measurements(&directory.path().join("press hall"));
    let options = endless().to_string();
    let mut watching = start(&server, &[&folder, "--kind", "identify", "--options", &options]);
    let mut said = BufReader::new(watching.stderr.take().unwrap()).lines().map(Result::unwrap);
    let made = said.find(|line| line.starts_with("batch ")).expect("it says what it has made");
    let id = made.split(' ').nth(1).unwrap().to_owned();
    kill_process(Pid::from_child(&watching), Signal::INT).unwrap();
    let rest: Vec<String> = said.collect();
    assert_eq!(watching.wait().unwrap().code(), Some(1));
    let how = format!("servoscope batch --resume {id} --server");
    assert!(rest.last().unwrap().contains(&how), "{rest:?}");
    let path = format!("/v1/batches/{id}");
    until(&server, &path, |batch| count(batch, "running") == 1);
    assert_eq!(server.post(&format!("{path}/cancel"), "text/plain", b"").status, 202);
    let resumed = run(&server, &["--resume", &id]);
    assert!(text(&resumed.stdout).contains("3 of 3 ended: 3 cancelled"), "{resumed:?}");
}

#[test]
fn what_cannot_be_asked_for_is_told_before_anything_is_uploaded() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(&directory.path().join("data"), &[]);
    let folder = measurements(&directory.path().join("runs"));
    let empty = directory.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let nowhere = directory.path().join("nowhere");
    for (arguments, reason) in [
        (vec![folder.as_str(), "--options", "{\"bees\": 1}"], "--options: "),
        (vec![empty.to_str().unwrap()], "no file in it can be computed"),
        (vec![nowhere.to_str().unwrap()], "there is no such file"),
        (vec!["--resume", "nobody"], "there is no batch `nobody`"),
    ] {
        let refused = run(&server, &arguments);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(text(&refused.stderr).contains(reason), "{refused:?}");
    }
    assert!(listed(&server, "measurements").is_empty());
}
