//! Connections to Postgres on which nothing is heard any more, and which nobody has closed.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::os::unix::net::UnixStream;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use serde_json::json;

use crate::durability::{count, is_running, until};
use crate::postgres_cluster::Cluster;
use crate::process::{command, simulated};
use crate::service::{endless, problem, submit};
use crate::worker_process::{Worker, server};

/// What a worker is heard of within.
const LEASE_S: u64 = 15;

/// A way to a database that can lose what is sent on it.
struct Link {
    address: String,
    made: Arc<AtomicUsize>,
    /// The connections that were made before this one lose what is sent.
    silent: Arc<AtomicUsize>,
}

impl Link {
    /// To a database of a cluster, which listens on a socket in a folder.
    fn to(database: &str) -> Self {
        let (start, folder) = database.split_once("?host=").unwrap();
        let name = start.rsplit('/').next().unwrap();
        let socket = format!("{folder}/.s.PGSQL.5432");
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let (made, silent) = (Arc::<AtomicUsize>::default(), Arc::<AtomicUsize>::default());
        let counts = (Arc::clone(&made), Arc::clone(&silent));
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                let number = counts.0.fetch_add(1, Ordering::SeqCst);
                let near = stream.unwrap();
                let far = UnixStream::connect(&socket).unwrap();
                pass(number, &counts.1, near, far);
            }
        });
        let address = format!("postgres://postgres@127.0.0.1:{port}/{name}?sslmode=disable");
        Self { address, made, silent }
    }

    /// Loses from now on what is sent, also on new connections.
    fn die(&self) {
        self.silent.store(usize::MAX, Ordering::SeqCst);
    }

    /// Loses from now on what is sent on the connections that there are, and on no others.
    fn fall_silent(&self) {
        self.silent.store(self.made.load(Ordering::SeqCst), Ordering::SeqCst);
    }
}

/// Passes on what either end of a connection sends.
fn pass(number: usize, silent: &Arc<AtomicUsize>, near: TcpStream, far: UnixStream) {
    let (from_near, to_far) = (near.try_clone().unwrap(), far.try_clone().unwrap());
    let lost = Arc::clone(silent);
    std::thread::spawn(move || {
        copy(number, &lost, from_near, &to_far);
        let _ = to_far.shutdown(Shutdown::Both);
    });
    let lost = Arc::clone(silent);
    std::thread::spawn(move || {
        copy(number, &lost, far, &near);
        let _ = near.shutdown(Shutdown::Both);
    });
}

/// Until one end closes the connection.
fn copy(number: usize, silent: &AtomicUsize, mut from: impl Read, mut to: impl Write) {
    let mut bytes = [0; 16 << 10];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        let lost = number < silent.load(Ordering::SeqCst);
        if !lost && to.write_all(&bytes[..count]).is_err() {
            return;
        }
    }
}

#[test]
fn a_worker_whose_connections_fall_silent_makes_new_ones_and_keeps_its_job() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let server = server(folder.path(), &database);
    let link = Link::to(&database);
    let mut worker = command();
    worker.args(["worker", "--workers", "1", "--database", &link.address]);
    worker.args(["--lease-seconds", &LEASE_S.to_string()]);
    let worker = worker.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let _worker = Worker(worker);
    let job = submit(&server, &endless());
    until(&server, &job, is_running);

    link.fall_silent();
    std::thread::sleep(Duration::from_secs(LEASE_S + 3));
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    let ended = server.get(&format!("{job}?wait=20")).json();
    assert_eq!((&ended["status"], &ended["attempt"]), (&json!("cancelled"), &json!(1)));
}

#[test]
fn an_upload_over_a_dead_link_is_answered_with_503_and_stored_once_when_it_is_repeated() {
    let Some(cluster) = Cluster::shared() else { return };
    let (database, folder) = (cluster.database(), tempfile::tempdir().unwrap());
    let link = Link::to(&database);
    let server = server(folder.path(), &link.address);
    let table = simulated(&[]);
    let upload = || {
        let headers = [("content-type", "text/csv"), ("idempotency-key", "upload")];
        server.post_with("/v1/measurements", &headers, &table)
    };
    link.die();
    // A connection that was used just now would be used again without being asked whether it is there.
    std::thread::sleep(Duration::from_secs(1));
    problem(&upload(), 503);
    assert_eq!(server.get("/livez").status, 200);
    assert_eq!(server.get("/readyz").status, 503);

    link.fall_silent();
    let answers = std::iter::repeat_with(upload).inspect(|answer| {
        // What was begun over the dead link may hold the connections for a while.
        assert!([200, 201, 503].contains(&answer.status), "{}", answer.text);
    });
    let stored = answers.take(30).find(|answer| answer.status != 503);
    let id = stored.expect("new connections are made").json()["id"].clone();
    assert_eq!(upload().json()["id"], id);
    assert_eq!(count(&server), 1);
}
