//! Nothing is lost: the real program killed, stopped, out of room and locked out.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::process::{Server, simulated};
use crate::service::{endless, problem, submit};
use crate::shared_files::skipped;

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(300);

/// What is promised to whoever stops a server. Held up by what still runs or waits
/// it would take a minute; by itself it takes a tenth of a second.
const STOPPING: Duration = Duration::from_secs(5);

/// One place, and a short wait for what a killed server held.
const ONE_PLACE: [&str; 6] = ["--workers", "1", "--lease-seconds", "2", "--retry-seconds", "0"];

/// Waits until a job says what is wanted of it.
pub fn until(server: &Server, job: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let now = server.get(job).json();
        if wanted(&now) {
            return now;
        }
        assert!(began.elapsed() < PATIENCE, "it stays at {now}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

pub fn is_running(job: &Value) -> bool {
    job["status"] == "running"
}

#[test]
fn a_job_that_kills_its_server_three_times_fails_with_the_reason_and_frees_its_place() {
    let directory = tempfile::tempdir().unwrap();
    let mut server = Server::start(directory.path(), &ONE_PLACE);
    let deadly = submit(&server, &endless());
    let behind = submit(&server, &json!({"seed": 5}));
    for attempt in 1..=3 {
        until(&server, &deadly, |job| is_running(job) && job["attempt"] == attempt);
        server.kill();
        server = Server::start(directory.path(), &ONE_PLACE);
    }
    let failed = server.ended(&deadly);
    assert_eq!(failed["status"], "failed", "{failed}");
    let reason = failed["failure"]["reason"].as_str().unwrap();
    assert!(reason.contains("stopped after 3 attempts"), "{reason}");
    let counted = "servoscope_jobs_ended_total{kind=\"identify\",outcome=\"failed\"} 1\n";
    let metrics = server.get("/metrics").text;
    assert!(metrics.contains(counted), "{metrics}");
    let ended = server.ended(&behind);
    assert_eq!(ended["status"], "succeeded", "{ended}");
}

#[test]
fn kills_of_a_server_with_several_jobs_in_hand_end_none_of_them() {
    let directory = tempfile::tempdir().unwrap();
    let two_places = ["--workers", "2", "--lease-seconds", "2"];
    let mut server = Server::start(directory.path(), &two_places);
    let jobs: Vec<String> = (0..6).map(|_| submit(&server, &endless())).collect();
    for kill in 1..=5 {
        let begun = || {
            let of = |job: &String| server.get(job).json()["attempt"].as_u64().unwrap();
            jobs.iter().map(of).sum::<u64>()
        };
        until(&server, &jobs[0], |_| begun() == 2 * kill);
        server.kill();
        server = Server::start(directory.path(), &two_places);
    }
    for job in &jobs {
        let status = server.get(job).json()["status"].clone();
        assert!(status == "queued" || status == "running", "{status}");
    }
}

#[test]
fn a_finished_result_stands_after_a_kill() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let job = submit(&server, &json!({"seed": 5}));
    assert_eq!(server.ended(&job)["status"], "succeeded");
    let [result, history] = ["result", "convergence"].map(|name| format!("{job}/{name}"));
    let before = [server.get(&result).text, server.get(&history).text];
    server.kill();
    let server = Server::start(directory.path(), &[]);
    assert_eq!([server.get(&result).text, server.get(&history).text], before);
}

#[test]
fn the_history_of_an_interrupted_job_is_told_on_without_a_gap() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ONE_PLACE);
    let job = submit(&server, &endless());
    let told = |server: &Server| server.get(&format!("{job}/convergence")).json();
    let any = |rows: &Value| !rows["rows"].as_array().unwrap().is_empty();
    until(&server, &job, |_| any(&told(&server)));
    server.kill();
    let server = Server::start(directory.path(), &ONE_PLACE);
    until(&server, &job, |job| is_running(job) && job["attempt"] == 2);
    until(&server, &job, |_| any(&told(&server)));
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    server.ended(&job);
    let events = server.get(&format!("{job}/events"));
    assert_eq!(events.content_type, "text/event-stream");
    let ids = events.text.lines().filter_map(|line| line.strip_prefix("id: "));
    let numbers: Vec<usize> = ids.map(|id| id.parse().unwrap()).collect();
    assert_eq!(numbers, (1..=numbers.len()).collect::<Vec<_>>(), "both attempts, then the end");
    assert!(numbers.len() > 2);
    assert_eq!(events.text.matches("event: end").count(), 1);
}

#[test]
fn stopping_waits_for_nobody_and_costs_no_attempt() {
    let directory = tempfile::tempdir().unwrap();
    // A job that was not handed back would be out of reach for the rest of the test.
    let arguments = ["--workers", "1", "--lease-seconds", "3600"];
    let mut server = Server::start(directory.path(), &arguments);
    let job = submit(&server, &endless());
    // One more than the attempts that a job has.
    for attempt in 1..=4 {
        until(&server, &job, |job| is_running(job) && job["attempt"] == attempt);
        let [mut stream, mut waiting] = ["events", "?wait=60"]
            .map(|end| {
                let slash = if end.starts_with('?') { "" } else { "/" };
                let url = format!("{}{job}{slash}{end}", server.address());
                std::thread::spawn(move || {
                    let mut text = String::new();
                    if let Ok(answer) = ureq::get(&url).call() {
                        // A connection that is cut has said what it had to say.
                        let _ = answer.into_body().into_reader().read_to_string(&mut text);
                    }
                    text
                })
            })
            .map(Some);
        std::thread::sleep(Duration::from_millis(200));
        let began = Instant::now();
        assert_eq!(server.terminate(), Some(0));
        assert!(began.elapsed() < STOPPING, "{:?}", began.elapsed());
        let told = stream.take().unwrap().join().unwrap();
        assert!(told.contains("\"running\"") && !told.contains("event: end"), "{told}");
        waiting.take().unwrap().join().unwrap();
        server = Server::start(directory.path(), &arguments);
    }
    until(&server, &job, is_running);
}

pub fn upload(server: &Server, table: &[u8]) -> crate::process::Answer {
    server.post("/v1/measurements", "text/csv", table)
}

pub fn count(server: &Server) -> usize {
    server.get("/v1/measurements").json()["items"].as_array().unwrap().len()
}

/// A measurement of about half a mebibyte: the rest is a remark.
fn large() -> Vec<u8> {
    let mut table = format!("# {}\n", "remark ".repeat(75_000)).into_bytes();
    table.extend(simulated(&[]));
    table
}

/// Uploads until there is no room, and gives what was stored.
pub fn fill(server: &Server, table: &[u8]) -> Vec<String> {
    let mut stored = Vec::new();
    for _ in 0..64 {
        let answer = upload(server, table);
        if answer.status != 201 {
            let refused = problem(&answer, 507);
            let detail = refused["detail"].as_str().unwrap();
            assert!(detail.contains("nothing of this request was stored"), "{detail}");
            return stored;
        }
        stored.push(answer.json()["id"].as_str().unwrap().to_owned());
    }
    panic!("there was room for {} of them", stored.len());
}

#[test]
fn a_full_database_refuses_what_it_has_no_room_for_and_recovers() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &["--max-store-mib", "3"]);
    let table = large();
    let stored = fill(&server, &table);
    assert!(!stored.is_empty());
    assert_eq!(count(&server), stored.len(), "half a measurement was stored");
    assert_eq!(server.delete(&format!("/v1/measurements/{}", stored[0])), 204);
    assert_eq!(upload(&server, &table).status, 201);
    assert_eq!(server.get("/readyz").status, 200);
}

/// A file system of its own, unmounted at the end.
pub struct Mounted(PathBuf);

impl Mounted {
    /// One of so many mebibytes, where this process may mount any.
    pub fn small(folder: &Path, mebibytes: usize) -> Option<Self> {
        let size = format!("size={mebibytes}m");
        let mount = ["-t", "tmpfs", "-o", size.as_str(), "tmpfs"];
        let done = Command::new("mount").args(mount).arg(folder).output().ok()?;
        done.status.success().then(|| Self(folder.to_owned()))
    }
}

impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = Command::new("umount").args(["--lazy"]).arg(&self.0).output();
    }
}

#[test]
fn a_full_disk_is_survived_without_a_restart() {
    let directory = tempfile::tempdir().unwrap();
    let Some(disk) = Mounted::small(directory.path(), 4) else {
        skipped("no file system can be mounted here");
        return;
    };
    let ballast = disk.0.join("ballast");
    std::fs::write(&ballast, vec![0; 1 << 20]).unwrap();
    let data = disk.0.join("data");
    let server = Server::start(&data, &ONE_PLACE);
    let job = submit(&server, &json!({"seed": 5}));
    assert_eq!(server.ended(&job)["status"], "succeeded");
    let table = large();
    let stored = fill(&server, &table);
    assert_eq!(count(&server), 1 + stored.len(), "half a measurement was stored");
    assert_eq!(server.get("/livez").status, 200);
    assert_eq!(server.get(&format!("{job}/result")).status, 200, "reading needs no room");
    std::fs::remove_file(&ballast).unwrap();
    assert_eq!(upload(&server, &table).status, 201);
    assert_eq!(server.get("/readyz").status, 200);
    let job = submit(&server, &json!({"seed": 6}));
    assert_eq!(server.ended(&job)["status"], "succeeded");
}

/// Makes the files of a folder unchangeable even for their owner, or changeable.
fn lock(folder: &Path, flag: &str) -> bool {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let done = Command::new("chattr").arg(flag).args(files).output();
    done.is_ok_and(|output| output.status.success())
}

#[test]
fn a_file_that_cannot_be_written_is_survived_without_a_restart() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ONE_PLACE);
    let small = simulated(&[]);
    assert_eq!(upload(&server, &small).status, 201);
    if !lock(directory.path(), "+i") {
        lock(directory.path(), "-i");
        skipped("no file can be made immutable here");
        return;
    }
    let refused = upload(&server, &small);
    let [ready, alive, listed] = ["/readyz", "/livez", "/v1/measurements"].map(|p| server.get(p));
    // Before anything is asserted: an immutable file cannot be removed.
    assert!(lock(directory.path(), "-i"));
    problem(&refused, 503);
    problem(&ready, 503);
    assert_eq!((alive.status, listed.status), (200, 200), "{}", listed.text);
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(count(&server), 1);
    let job = submit(&server, &json!({"seed": 6}));
    assert_eq!(server.ended(&job)["status"], "succeeded");
}
