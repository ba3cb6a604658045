//! A receiver of webhooks that answers as a test wants.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};
use serde_json::Value;

use crate::certificates::Certificate;

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
    scheme: &'static str,
    received: mpsc::Receiver<Received>,
}

impl Receiver {
    /// `answers`: status lines and headers, as in `204 No Content`.
    pub fn start(answers: &[&str]) -> Self {
        Self::listening(TcpListener::bind("127.0.0.1:0").unwrap(), None, answers)
    }

    /// The same over TLS.
    pub fn start_tls(certificate: &Certificate, answers: &[&str]) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        Self::listening(listener, Some(tls(certificate)), answers)
    }

    /// The same on an address where nobody listens.
    pub fn start_at(address: SocketAddr, answers: &[&str]) -> Self {
        Self::listening(TcpListener::bind(address).unwrap(), None, answers)
    }

    fn listening(listener: TcpListener, tls: Option<Arc<ServerConfig>>, answers: &[&str]) -> Self {
        let scheme = if tls.is_some() { "https" } else { "http" };
        let address = listener.local_addr().unwrap();
        let (sender, received) = mpsc::channel();
        let answers: Vec<String> = answers.iter().map(|answer| (*answer).to_owned()).collect();
        std::thread::spawn(move || {
            for (index, stream) in listener.incoming().enumerate() {
                let answer = answers.get(index).or(answers.last()).unwrap();
                // A connection that breaks is no request.
                let request = stream.ok().and_then(|stream| match &tls {
                    None => answered(stream, answer),
                    Some(config) => {
                        let session = ServerConnection::new(Arc::clone(config)).unwrap();
                        answered(StreamOwned::new(session, stream), answer)
                    }
                });
                let Some(request) = request else {
                    continue;
                };
                if sender.send(request).is_err() {
                    return;
                }
            }
        });
        Self { address, scheme, received }
    }

    pub fn url(&self) -> String {
        format!("{}://{}/hook", self.scheme, self.address)
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

fn tls(certificate: &Certificate) -> Arc<ServerConfig> {
    let chain = vec![CertificateDer::from_pem_file(&certificate.file).unwrap()];
    let key = PrivateKeyDer::from_pem_file(&certificate.key).unwrap();
    let config = ServerConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_no_client_auth()
        .with_single_cert(chain, key);
    Arc::new(config.unwrap())
}

fn answered<S: Read + Write>(stream: S, answer: &str) -> Option<Received> {
    let mut reader = BufReader::new(stream);
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
    let stream = reader.get_mut();
    stream.write_all(answer.as_bytes()).ok()?;
    stream.flush().ok()?;
    Some(Received { headers, body: String::from_utf8(body).ok()? })
}
