//! A receiver of webhooks that answers as a test wants.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use serde_json::Value;

/// Far more than anything here takes: it ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// A request as it came.
pub struct Received {
    headers: HashMap<String, String>,
    pub body: String,
}

impl Received {
    /// A header, by its name in lower case.
    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", String::as_str)
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap()
    }
}

/// Answers each request with the next of its answers, and the last for ever.
pub struct Receiver {
    address: SocketAddr,
    received: mpsc::Receiver<Received>,
}

impl Receiver {
    /// `answers`: status lines and headers, as in `204 No Content`.
    pub fn start(answers: &[&str]) -> Self {
        Self::listening(TcpListener::bind("127.0.0.1:0").unwrap(), answers)
    }

    /// The same on an address where nobody listens.
    pub fn start_at(address: SocketAddr, answers: &[&str]) -> Self {
        Self::listening(TcpListener::bind(address).unwrap(), answers)
    }

    fn listening(listener: TcpListener, answers: &[&str]) -> Self {
        let address = listener.local_addr().unwrap();
        let (sender, received) = mpsc::channel();
        let answers: Vec<String> = answers.iter().map(|answer| (*answer).to_owned()).collect();
        std::thread::spawn(move || {
            for (index, stream) in listener.incoming().enumerate() {
                let answer = answers.get(index).or(answers.last()).unwrap();
                // A connection that breaks is no request.
                let Some(request) = stream.ok().and_then(|stream| answered(stream, answer)) else {
                    continue;
                };
                if sender.send(request).is_err() {
                    return;
                }
            }
        });
        Self { address, received }
    }

    pub fn url(&self) -> String {
        format!("http://{}/hook", self.address)
    }

    /// The next request.
    pub fn next(&self) -> Received {
        self.received.recv_timeout(PATIENCE).expect("a message arrives")
    }

    /// Whether nothing has come.
    pub fn is_untouched(&self) -> bool {
        self.received.try_recv().is_err()
    }
}

/// An address where nobody listens, and that nobody is given who asks the system for any.
pub fn free_address() -> SocketAddr {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    let first = 20_000 + (std::process::id() % 10_000) as u16;
    loop {
        let port = first + NEXT.fetch_add(1, Ordering::Relaxed);
        if let Ok(listener) = TcpListener::bind(("127.0.0.1", port)) {
            return listener.local_addr().unwrap();
        }
    }
}

fn answered(mut stream: TcpStream, answer: &str) -> Option<Received> {
    let mut reader = BufReader::new(stream.try_clone().ok()?);
    let mut headers = HashMap::new();
    let mut line = String::new();
    reader.read_line(&mut line).ok()?;
    loop {
        line.clear();
        reader.read_line(&mut line).ok()?;
        let Some((name, value)) = line.trim_end().split_once(": ") else { break };
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length = headers.get("content-length")?.parse().ok()?;
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    let answer = format!("HTTP/1.1 {answer}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    stream.write_all(answer.as_bytes()).ok()?;
    Some(Received { headers, body: String::from_utf8(body).ok()? })
}
