//! Many connections to the real program.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::process::Server;

/// Ends a test that hangs; far less than a connection may be idle.
const PATIENCE: Duration = Duration::from_secs(20);

/// Files that the server may have open here.
const FILES: u64 = 256;

fn connect(server: &Server, sent: &str) -> Option<TcpStream> {
    let address = server.address().trim_start_matches("http://");
    let mut stream = TcpStream::connect(address).ok()?;
    stream.set_read_timeout(Some(Duration::from_secs(60))).ok()?;
    stream.write_all(sent.as_bytes()).ok()?;
    Some(stream)
}

/// What is answered to a request of its own connection.
fn asked(server: &Server, path: &str) -> String {
    let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    let mut text = String::new();
    if let Some(mut stream) = connect(server, &request) {
        // One that is reset has said what it had to say.
        let _ = stream.read_to_string(&mut text);
    }
    text
}

#[test]
fn more_connections_than_files_stop_no_answer() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start_with_files(directory.path(), FILES);
    let idle: Vec<_> = (0..2 * FILES).map(|_| connect(&server, "")).collect();
    for path in ["/livez", "/readyz", "/metrics", "/v1/measurements"] {
        let text = asked(&server, path);
        assert!(text.starts_with("HTTP/1.1 200"), "{path}: {text}");
    }
    drop(idle);

    // None of these is idle: each has a request whose body does not come.
    let head = "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\n\
                content-length: 100\r\n\r\nabc";
    let mut busy: Vec<_> = (0..2 * FILES).map(|_| connect(&server, head)).collect();
    for path in ["/livez", "/readyz", "/metrics"] {
        let text = asked(&server, path);
        assert!(text.starts_with("HTTP/1.1 200"), "{path}: {text}");
    }
    // All come from one address, which may have half of the connections busy. One whose head is not
    // read yet counts as idle, and is closed for the next one: others come in its place.
    let began = Instant::now();
    loop {
        let refused = asked(&server, "/v1/measurements");
        if refused.starts_with("HTTP/1.1 429") && refused.contains("problem+json") {
            break;
        }
        assert!(began.elapsed() < PATIENCE, "{refused}");
        busy.push(connect(&server, head));
    }
    drop(busy);
}
