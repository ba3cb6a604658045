//! More connections than the server keeps.

use std::io::{Read, Write};
use std::net::TcpStream;

use super::*;

/// Connections that the server keeps here.
const KEPT: usize = 8;

fn server(idle: Duration) -> Server {
    Server::start_keeping(Vec::new(), Keeping { idle, ..Keeping::new(KEPT) })
}

fn connect(server: &Server, sent: &str) -> TcpStream {
    let mut stream = TcpStream::connect(server.address.trim_start_matches("http://")).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    stream.write_all(sent.as_bytes()).unwrap();
    stream
}

/// What is answered before the server closes the connection.
fn answered(mut stream: TcpStream) -> String {
    let mut text = String::new();
    // One that is reset has said what it had to say.
    let _ = stream.read_to_string(&mut text);
    text
}

/// A request of a key whose body is asked for and does not come.
fn unfinished(server: &Server, key: &str) -> TcpStream {
    let head = format!(
        "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\nexpect: 100-continue\r\n\
         authorization: Bearer {key}\r\ncontent-type: text/csv\r\ncontent-length: 100\r\n\r\n"
    );
    let mut stream = connect(server, &head);
    let mut asked = [0; 25];
    stream.read_exact(&mut asked).unwrap();
    assert_eq!(&asked, b"HTTP/1.1 100 Continue\r\n\r\n");
    stream
}

/// Such requests on every connection: one key has half of them.
fn all_busy(server: &Server, keys: [&str; 2]) -> Vec<TcpStream> {
    (0..KEPT).map(|index| unfinished(server, keys[index % 2])).collect()
}

/// What is answered to a request on a connection of its own.
fn asked(server: &Server, path: &str, key: &str) -> String {
    let head = format!(
        "GET {path} HTTP/1.1\r\nhost: localhost\r\nauthorization: Bearer {key}\r\n\
         connection: close\r\n\r\n"
    );
    answered(connect(server, &head))
}

const SCOPES: [Scope; 4] = [Scope::Upload, Scope::Run, Scope::Read, Scope::Metrics];

#[test]
fn idle_connections_and_half_heads_make_room_for_those_who_ask() {
    let server = server(Duration::from_secs(75));
    let idle: Vec<TcpStream> = (0..10 * KEPT)
        .map(|index| connect(&server, if index % 2 == 0 { "" } else { "GET /livez HTT" }))
        .collect();
    for path in ["/livez", "/v1/jobs"] {
        let request =
            format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
        let text = answered(connect(&server, &request));
        assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    }
    // The first has made room.
    assert_eq!(answered(idle.into_iter().next().unwrap()), "");
}

#[test]
fn where_every_connection_is_busy_an_operator_is_answered_and_others_are_told() {
    let server = server(Duration::from_secs(75));
    let [(_, one), (_, other)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let busy = all_busy(&server, [&one, &other]);
    let refused = asked(&server, "/v1/jobs", &one).to_ascii_lowercase();
    assert!(refused.starts_with("http/1.1 503"), "{refused}");
    assert!(refused.contains("retry-after: ") && refused.contains("problem+json"), "{refused}");
    for path in ["/livez", "/readyz", "/metrics"] {
        let text = asked(&server, path, &one);
        assert!(text.starts_with("HTTP/1.1 200"), "{path}: {text}");
    }
    drop(busy);
    while !asked(&server, "/v1/jobs", &one).starts_with("HTTP/1.1 200") {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_key_has_half_of_the_connections_busy_and_leaves_the_others() {
    let server = server(Duration::from_secs(75));
    let [(_, flood), (_, rig)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let busy: Vec<TcpStream> = (0..KEPT / 2).map(|_| unfinished(&server, &flood)).collect();
    let refused = asked(&server, "/v1/jobs", &flood).to_ascii_lowercase();
    assert!(refused.starts_with("http/1.1 429"), "{refused}");
    assert!(refused.contains("retry-after: 5\r\n"), "{refused}");
    assert!(refused.contains("this key has 4 requests under way"), "{refused}");
    for path in ["/livez", "/readyz", "/metrics"] {
        let text = asked(&server, path, &flood);
        assert!(text.starts_with("HTTP/1.1 200"), "{path}: {text}");
    }
    assert!(asked(&server, "/v1/jobs", &rig).starts_with("HTTP/1.1 200"));
    drop(busy);
    while !asked(&server, "/v1/jobs", &flood).starts_with("HTTP/1.1 200") {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn whoever_follows_events_is_under_way_until_they_end() {
    let server = server(Duration::from_secs(75));
    let job = server.job(RUN_UNTIL_CANCELLED);
    let request = format!("GET /v1/jobs/{job}/events HTTP/1.1\r\nhost: localhost\r\n\r\n");
    let streams: Vec<TcpStream> = (0..KEPT / 2)
        .map(|_| {
            let mut stream = connect(&server, &request);
            stream.read_exact(&mut [0; 16]).unwrap();
            stream
        })
        .collect();
    // Without a key it is the address that counts.
    let refused = asked(&server, "/v1/jobs", "none");
    assert!(refused.starts_with("HTTP/1.1 429"), "{refused}");
    assert!(refused.contains("from your address"), "{refused}");
    server.runtime.block_on(server.service.cancel(&job)).unwrap();
    // Their connections stay, and are idle.
    while !asked(&server, "/v1/jobs", "none").starts_with("HTTP/1.1 200") {
        std::thread::sleep(Duration::from_millis(10));
    }
    drop(streams);
}

#[test]
fn a_body_that_nobody_wants_is_not_waited_for() {
    let server = server(Duration::from_secs(75));
    let (_, key) = server.key(&SCOPES);
    for (line, status) in [
        ("GET /livez", "200"),
        ("GET /metrics", "200"),
        ("POST /nothing/here", "404"),
        ("GET /v1/session", "401"),
    ] {
        let authorization = match line {
            "GET /metrics" => format!("authorization: Bearer {key}\r\n"),
            _ => String::new(),
        };
        let began = Instant::now();
        let head = format!(
            "{line} HTTP/1.1\r\nhost: localhost\r\n{authorization}content-length: 9000\r\n\r\nabc"
        );
        let text = answered(connect(&server, &head));
        assert!(text.starts_with(&format!("HTTP/1.1 {status}")), "{line}: {text}");
        assert!(began.elapsed() < Duration::from_secs(20), "{line}: {:?}", began.elapsed());
    }
}

#[test]
fn a_connection_without_a_request_is_closed_after_a_while_and_a_stream_is_not() {
    let server = server(Duration::from_millis(300));
    let job = server.job(RUN_UNTIL_CANCELLED);
    let request = format!("GET /v1/jobs/{job}/events HTTP/1.1\r\nhost: localhost\r\n\r\n");
    let mut stream = connect(&server, &request);
    for sent in ["", "GET /livez HTT", "GET /livez HTTP/1.1\r\nhost: localhost\r\n\r\n"] {
        let text = answered(connect(&server, sent));
        assert_eq!(text.starts_with("HTTP/1.1 200"), sent.ends_with("\r\n\r\n"), "{text}");
    }
    assert_eq!(stream.read(&mut [0; 16]).unwrap(), 16);
    let cancel = server.post(&format!("/v1/jobs/{job}/cancel"), &[], b"");
    assert_eq!(cancel.status(), 202);
    let mut text = String::new();
    while !text.contains("event: end") {
        let mut bytes = [0; 1024];
        let read = stream.read(&mut bytes).unwrap();
        assert_ne!(read, 0, "it was closed: {text}");
        text.push_str(&String::from_utf8_lossy(&bytes[..read]));
    }
}

/// The value of a sample of the metrics.
fn counted(server: &Server, key: &str, sample: &str) -> i64 {
    let authorization = format!("Bearer {key}");
    let answer = server.send("GET", "/metrics", &[("authorization", &authorization)], b"");
    let text = answer.into_body().read_to_string().unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix(sample)?.strip_prefix(' '));
    line.unwrap_or_else(|| panic!("no {sample} in\n{text}")).parse().unwrap()
}

#[test]
fn connections_that_are_open_refused_and_closed_are_counted() {
    let server = server(Duration::from_millis(300));
    let [(_, one), (_, other)] = [server.key(&SCOPES), server.key(&SCOPES)];
    // The one that asks for the metrics is kept.
    assert_eq!(counted(&server, &one, "servoscope_connections_open"), 1);
    answered(connect(&server, "GET /livez HTT"));
    let closed = |why: &str| format!("servoscope_connections_closed_total{{why=\"{why}\"}}");
    while counted(&server, &one, &closed("idle")) == 0 {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(counted(&server, &one, "servoscope_connections_refused_total"), 0);
    // Every place is taken by a request that is under way; only what is idle makes room.
    let busy = all_busy(&server, [&one, &other]);
    assert!(counted(&server, &one, &closed("room")) <= 1);
    let refused = counted(&server, &one, "servoscope_connections_refused_total");
    assert!(refused >= 1, "the one that asks");
    assert!(counted(&server, &one, "servoscope_connections_open") > KEPT as i64);
    drop(busy);
    while counted(&server, &one, "servoscope_connections_open") > 1 {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_refused_request_whose_body_comes_later_leaves_its_connection_usable() {
    let server = server(Duration::from_secs(75));
    server.key(&[Scope::Read]);
    let head = |more: &str| {
        format!(
            "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\ncontent-length: 3\r\n{more}\r\n"
        )
    };
    // Without the key that the gate asks for, and from a foreign page.
    for (more, status) in [("", "401"), ("origin: https://evil.example\r\n", "403")] {
        let mut stream = connect(&server, &head(more));
        // Time for the server to refuse it, were it to look at the head alone.
        std::thread::sleep(Duration::from_millis(100));
        stream.write_all(b"any").unwrap();
        let next = "GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";
        stream.write_all(next.as_bytes()).unwrap();
        let text = answered(stream);
        assert!(text.starts_with(&format!("HTTP/1.1 {status}")), "{text}");
        assert!(text.contains("HTTP/1.1 200"), "the connection was closed: {text}");
    }
}
