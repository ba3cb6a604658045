//! Requests whose answer never came, because the server was killed.

use std::io::Write;
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

use serde_json::Value;

use crate::postgres_cluster::Cluster;
use crate::process::{Server, simulated};

/// How long after the request the server is killed, ms: before it has read all, while it stores, and
/// when it has answered.
const DELAYS_MS: [u64; 8] = [0, 2, 4, 8, 15, 30, 60, 250];

/// Sends an upload on a connection from which nothing is read.
fn sent(server: &Server, key: &str, body: &[u8]) -> TcpStream {
    let address = server.address().trim_start_matches("http://");
    let mut stream = TcpStream::connect(address).unwrap();
    let head = format!(
        "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\n\
         idempotency-key: {key}\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.write_all(body).unwrap();
    stream
}

fn stored(server: &Server) -> Vec<Value> {
    let all = server.get("/v1/measurements?limit=200").json();
    all["items"].as_array().unwrap().iter().map(|item| item["id"].clone()).collect()
}

fn repeated(start: impl Fn(&Path) -> Server) {
    let folder = tempfile::tempdir().unwrap();
    let table = simulated(&[]);
    let mut server = start(folder.path());
    let mut known = Vec::new();
    let mut were_stored = Vec::new();
    for delay in DELAYS_MS {
        let key = format!("upload-{delay}");
        let connection = sent(&server, &key, &table);
        std::thread::sleep(Duration::from_millis(delay));
        server.kill();
        drop(connection);
        server = start(folder.path());
        let before: Vec<Value> =
            stored(&server).into_iter().filter(|id| !known.contains(id)).collect();
        let again = || {
            let headers = [("content-type", "text/csv"), ("idempotency-key", key.as_str())];
            let answer = server.post_with("/v1/measurements", &headers, &table);
            assert!([200, 201].contains(&answer.status), "{}", answer.text);
            answer.json()["id"].clone()
        };
        let id = again();
        assert_eq!(again(), id, "{delay} ms");
        assert!(before.is_empty() || before == [id.clone()], "{delay} ms: {before:?}, not {id}");
        were_stored.push(!before.is_empty());
        known.push(id);
        let mut now = stored(&server);
        now.reverse();
        assert_eq!(now, known, "{delay} ms: each upload once");
    }
    assert_eq!(were_stored.last(), Some(&true), "the last one was stored, and its answer not read");
}

#[test]
fn an_upload_whose_answer_was_lost_is_repeated_with_its_key_and_stored_once() {
    repeated(|folder| Server::start(folder, &["--workers", "0"]));
}

#[test]
fn the_same_on_postgres() {
    let Some(cluster) = Cluster::shared() else { return };
    let database = cluster.database();
    repeated(|folder| Server::start(folder, &["--workers", "0", "--database", &database]));
}
