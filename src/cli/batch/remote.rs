//! A server that a command asks.

use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar};
use reqwest::{Client, Response, StatusCode, Url, header};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::cli::Failure;
use crate::config::SecretText;
use crate::notify::tls_config;

use super::request::Request;

/// The longest that one request may take.
const ONE_REQUEST: Duration = Duration::from_secs(120);

/// How long a server may be away, as while it is started again; and between two attempts.
const AWAY: Duration = Duration::from_secs(600);
const PAUSE: Duration = Duration::from_secs(2);

/// What a server says is wrong with a request.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Refusal {
    /// In words.
    pub(super) detail: String,
    /// The member of the request.
    pub(super) member: Option<String>,
    /// Status of the answer.
    pub(super) status: u16,
}

impl Refusal {
    /// Whether it is about the file that was sent: it is unreadable or too large, and the next one
    /// may be taken.
    pub(super) fn is_of_file(&self) -> bool {
        matches!(self.status, 400 | 413 | 415 | 422)
    }
}

/// Why a request was not answered.
#[derive(Debug, thiserror::Error)]
pub(super) enum Sent {
    /// The server refuses it.
    #[error("{}", .0.detail)]
    Refused(Refusal),
    /// There is no server, or it does not speak as it should.
    #[error("{0}")]
    Unanswered(String),
}

impl From<Sent> for Failure {
    fn from(sent: Sent) -> Self {
        match sent {
            Sent::Refused(_) => Self::input(sent),
            Sent::Unanswered(_) => Self::other(sent),
        }
    }
}

/// A server.
#[derive(Debug)]
pub(super) struct Remote {
    client: Client,
    address: String,
    key: Option<SecretText>,
    bars: MultiProgress,
}

impl Remote {
    /// # Errors
    /// [`Failure::Input`] where the address is none.
    pub(super) fn new(address: &str, key: Option<&SecretText>) -> Result<Self, Failure> {
        let http = |url: &Url| matches!(url.scheme(), "http" | "https");
        if !Url::parse(address).is_ok_and(|url| http(&url)) {
            return Err(Failure::Input(format!(
                "--server: `{address}` is not an address as in `https://servo.example`"
            )));
        }
        let client = Client::builder()
            .user_agent(concat!("servoscope/", env!("CARGO_PKG_VERSION")))
            .tls_backend_preconfigured(tls_config())
            .timeout(ONE_REQUEST)
            .build()
            .map_err(Failure::other)?;
        let address = address.trim_end_matches('/').to_owned();
        Ok(Self { client, address, key: key.cloned(), bars: MultiProgress::new() })
    }

    /// A bar on standard error, where that is a terminal.
    pub(super) fn bar(&self, length: u64) -> ProgressBar {
        self.bars.add(ProgressBar::new(length))
    }

    /// Says something on standard error, above the bars.
    pub(super) fn say(&self, text: &str) {
        self.bars.suspend(|| eprintln!("{text}"));
    }

    pub(super) fn address(&self) -> &str {
        &self.address
    }

    /// Asks for something small, so that a wrong address or key is told at once.
    ///
    /// # Errors
    /// [`Failure::Other`] where nobody answers, [`Failure::Input`] where the key is refused.
    pub(super) async fn greet(&self) -> Result<(), Failure> {
        let answer = self.send(&Request::get("/v1/batches?limit=1")).await;
        let answer = answer.map_err(|error| {
            Failure::Other(format!("no server answers at {}: {}", self.address, innermost(&error)))
        })?;
        match answer.status().is_success() {
            true => Ok(()),
            false => Err(refused(answer).await.into()),
        }
    }

    /// The JSON of an answer. A server that is away, or busy, is asked again; every request here may
    /// be repeated.
    ///
    /// # Errors
    /// [`Sent`].
    pub(super) async fn json(&self, request: &Request) -> Result<Value, Sent> {
        let mut away: Option<Instant> = None;
        loop {
            let (reason, pause) = match self.send(request).await {
                Ok(answer) if answer.status().is_success() => match answer.bytes().await {
                    Ok(bytes) => return parsed(&bytes),
                    Err(error) => (innermost(&error), PAUSE),
                },
                Ok(answer) => match wait(&answer) {
                    // It says when to come back: that is no failure.
                    Some(pause) if answer.status() == StatusCode::TOO_MANY_REQUESTS => {
                        if let Sent::Refused(refusal) = refused(answer).await {
                            self.say(&format!("the server is busy: {}", refusal.detail));
                        }
                        tokio::time::sleep(pause).await;
                        continue;
                    }
                    Some(pause) => (format!("it answers {}", answer.status()), pause),
                    None => return Err(refused(answer).await),
                },
                Err(error) => (innermost(&error), PAUSE),
            };
            let since = *away.get_or_insert_with(|| {
                self.say(&format!("the server does not answer ({reason}); trying again"));
                Instant::now()
            });
            if since.elapsed() > AWAY {
                let minutes = AWAY.as_secs() / 60;
                return Err(Sent::Unanswered(format!(
                    "{} has not answered for {minutes} minutes: {reason}; run the same command \
                     again to continue",
                    self.address
                )));
            }
            tokio::time::sleep(pause).await;
        }
    }

    async fn send(&self, request: &Request) -> Result<Response, reqwest::Error> {
        let url = format!("{}{}", self.address, request.path);
        let mut builder = self.client.request(request.method.clone(), url);
        if let Some(key) = &self.key {
            builder = builder.bearer_auth(key.reveal());
        }
        if let Some(key) = &request.key {
            builder = builder.header("idempotency-key", key);
        }
        builder = request.body(builder);
        builder.send().await
    }
}

/// How long to wait before a request is sent again; `None`: it will be answered in the same way.
fn wait(answer: &Response) -> Option<Duration> {
    let said = answer.headers().get(header::RETRY_AFTER).and_then(|value| value.to_str().ok());
    let said = said.and_then(|text| text.parse().ok()).map(Duration::from_secs);
    match answer.status() {
        StatusCode::TOO_MANY_REQUESTS => said,
        StatusCode::BAD_GATEWAY | StatusCode::SERVICE_UNAVAILABLE | StatusCode::GATEWAY_TIMEOUT => {
            Some(said.unwrap_or(PAUSE))
        }
        _ => None,
    }
}

async fn refused(answer: Response) -> Sent {
    let status = answer.status();
    let url = answer.url().clone();
    let said = answer.bytes().await.ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    match said {
        Some(refusal) => Sent::Refused(refusal),
        None => Sent::Unanswered(format!("{url} answers {status}; is it a servoscope server?")),
    }
}

fn parsed(bytes: &[u8]) -> Result<Value, Sent> {
    let wrong = |error| Sent::Unanswered(format!("the answer of the server is not JSON: {error}"));
    serde_json::from_slice(bytes).map_err(wrong)
}

/// An answer as what it should say.
///
/// # Errors
/// [`Failure::Other`] where it says something else.
pub(super) fn read<T: DeserializeOwned>(answer: Value) -> Result<T, Failure> {
    let wrong = |error| {
        Failure::Other(format!("the server answers what this version does not know: {error}"))
    };
    serde_json::from_value(answer).map_err(wrong)
}

/// What lies at the bottom of a failure of the client, without the address that it was about.
fn innermost(error: &reqwest::Error) -> String {
    let mut last: &dyn std::error::Error = error;
    while let Some(source) = last.source() {
        last = source;
    }
    last.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_that_is_none_is_refused() {
        for wrong in ["servo.example", "ftp://servo.example", ""] {
            let refused = Remote::new(wrong, None).unwrap_err().to_string();
            assert!(refused.starts_with("--server: "), "{refused}");
        }
        assert_eq!(Remote::new("http://a:1/", None).unwrap().address(), "http://a:1");
    }

    #[tokio::test]
    async fn a_server_that_is_not_there_is_told_at_once() {
        // Bound and closed again: nobody listens there.
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let remote = Remote::new(&format!("http://127.0.0.1:{port}"), None).unwrap();
        let failed = remote.greet().await.unwrap_err().to_string();
        assert!(failed.starts_with("no server answers at http://127.0.0.1:"), "{failed}");
    }
}
