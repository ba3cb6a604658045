//! Sending a webhook.

use std::error::Error;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, OnceLock};

use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::{Client, Response, Url, header, redirect};
use tracing::info;

use super::{Allowed, PATIENCE, Secret, SendError, tls};

/// What is read of an answer: enough for the receiver to say what it has to say. Nobody
/// looks at it.
const ANSWER_BYTES: usize = 16 << 10;

/// The longest address that is taken.
const URL_BYTES: usize = 2000;

/// Sends webhooks to where they may go.
#[derive(Debug, Default)]
pub struct Webhooks {
    allowed: Arc<Allowed>,
    /// Made when it is first needed: it reads the certificates of the system.
    client: OnceLock<Client>,
}

impl Webhooks {
    /// Sends to public addresses and what else is allowed.
    pub fn new(allowed: Allowed) -> Self {
        Self { allowed: Arc::new(allowed), client: OnceLock::new() }
    }

    /// Whether messages may be sent there, as its name resolves now.
    ///
    /// # Errors
    /// [`SendError::Url`], [`SendError::Forbidden`] or [`SendError::Unresolved`].
    pub async fn check(&self, url: &str) -> Result<(), SendError> {
        let url = parsed(url)?;
        let host = url.host_str().unwrap_or_default();
        match literal(&url) {
            Some(address) => self.permitted(host, address),
            None => resolved(host, &self.allowed).await.map(|_| ()),
        }
    }

    /// Sends a message, `timestamp` in seconds since 1970, and gives the status of the answer.
    ///
    /// # Errors
    /// Why it was not taken.
    pub async fn send(
        &self,
        url: &str,
        secret: &Secret,
        id: &str,
        timestamp: i64,
        body: &str,
    ) -> Result<u16, SendError> {
        let url = parsed(url)?;
        // A name is checked when it is resolved; an address is never resolved.
        if let Some(address) = literal(&url) {
            self.permitted(url.host_str().unwrap_or_default(), address)?;
        }
        let request = self
            .client()?
            .post(url)
            .header(header::CONTENT_TYPE, "application/json")
            .header("webhook-id", id)
            .header("webhook-timestamp", timestamp)
            .header("webhook-signature", secret.sign(id, timestamp, body))
            .body(body.to_owned());
        let answer = request.send().await.map_err(|error| failure(&error))?;
        let status = answer.status();
        read(answer).await;
        match status.as_u16() {
            code if status.is_success() => Ok(code),
            410 => Err(SendError::Gone),
            code if status.is_redirection() => Err(SendError::Redirected(code)),
            code => Err(SendError::Status(code)),
        }
    }

    fn permitted(&self, host: &str, address: IpAddr) -> Result<(), SendError> {
        match self.allowed.permits(address) {
            true => Ok(()),
            false => Err(SendError::Forbidden { host: host.to_owned(), address }),
        }
    }

    fn client(&self) -> Result<&Client, SendError> {
        if let Some(client) = self.client.get() {
            return Ok(client);
        }
        let client = Client::builder()
            .user_agent(concat!("servoscope/", env!("CARGO_PKG_VERSION")))
            .tls_backend_preconfigured(tls::config())
            .dns_resolver(Arc::new(Checked(Arc::clone(&self.allowed))))
            .redirect(redirect::Policy::none())
            // A proxy would connect to addresses that nobody has checked.
            .no_proxy()
            .pool_max_idle_per_host(0)
            .timeout(PATIENCE)
            .build()
            .map_err(|error| failure(&error))?;
        Ok(self.client.get_or_init(|| client))
    }
}

/// Resolves names to addresses that are allowed. The connection is made to just these.
struct Checked(Arc<Allowed>);

impl Resolve for Checked {
    fn resolve(&self, name: Name) -> Resolving {
        let allowed = Arc::clone(&self.0);
        Box::pin(async move {
            let addresses = resolved(name.as_str(), &allowed).await?;
            Ok(Box::new(addresses.into_iter()) as Addrs)
        })
    }
}

/// Addresses of a name, each of them allowed.
async fn resolved(host: &str, allowed: &Allowed) -> Result<Vec<SocketAddr>, SendError> {
    let unresolved = |reason: String| SendError::Unresolved { host: host.to_owned(), reason };
    let found = tokio::net::lookup_host((host, 0));
    let found = match tokio::time::timeout(PATIENCE, found).await {
        Ok(found) => found.map_err(|error| unresolved(error.to_string()))?,
        Err(_) => return Err(SendError::TimedOut),
    };
    let addresses: Vec<SocketAddr> = found.collect();
    match addresses.iter().find(|address| !allowed.permits(address.ip())) {
        Some(wrong) => {
            let address = wrong.ip();
            info!(host, %address, "the name of a webhook leads to an address that is not allowed");
            Err(SendError::Forbidden { host: host.to_owned(), address })
        }
        None if addresses.is_empty() => Err(unresolved("it has no address".into())),
        None => Ok(addresses),
    }
}

fn parsed(text: &str) -> Result<Url, SendError> {
    let wrong = |reason| SendError::Url { url: text.to_owned(), reason };
    let url = Url::parse(text).map_err(|_| wrong("it is not a URL as in `https://host/path`"))?;
    if !matches!(url.scheme(), "http" | "https") {
        return Err(wrong("only http and https are spoken"));
    }
    if !url.username().is_empty() || url.password().is_some() {
        return Err(wrong("it names a user; the signature says who sends"));
    }
    if text.len() > URL_BYTES {
        return Err(wrong("it is longer than 2000 bytes"));
    }
    Ok(url)
}

/// The host where it is an address and no name.
fn literal(url: &Url) -> Option<IpAddr> {
    url.host_str()?.trim_matches(['[', ']']).parse().ok()
}

/// Reads the beginning of an answer; what comes of it changes nothing.
async fn read(mut answer: Response) {
    let mut bytes = 0;
    while let Ok(Some(chunk)) = answer.chunk().await {
        bytes += chunk.len();
        if bytes > ANSWER_BYTES {
            return;
        }
    }
}

/// What the client says of a failure, without the address that it was about.
fn failure(error: &reqwest::Error) -> SendError {
    let mut source = error.source();
    let mut last = String::new();
    while let Some(error) = source {
        if let Some(known) = error.downcast_ref::<SendError>() {
            return known.clone();
        }
        last = error.to_string();
        source = error.source();
    }
    match error.is_timeout() {
        true => SendError::TimedOut,
        false => SendError::Connection(last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn sent(webhooks: &Webhooks, url: &str) -> Result<u16, SendError> {
        let secret = Secret::generate().unwrap();
        webhooks.send(url, &secret, "msg_1", 1_614_265_330, "{}").await
    }

    #[tokio::test]
    async fn an_address_that_is_not_public_is_refused_however_it_is_written() {
        let webhooks = Webhooks::default();
        for url in [
            "http://127.0.0.1:1/",
            "http://localhost:1/",
            "http://0x7f.1:1/",
            "http://2130706433:1/",
            "http://[::1]:1/",
            "http://[::ffff:127.0.0.1]:1/",
            "http://0/",
            "https://169.254.169.254/latest/meta-data/",
        ] {
            let checked = webhooks.check(url).await;
            assert!(matches!(checked, Err(SendError::Forbidden { .. })), "{url}: {checked:?}");
            let sent = sent(&webhooks, url).await;
            assert!(matches!(sent, Err(SendError::Forbidden { .. })), "{url}: {sent:?}");
        }
    }

    #[tokio::test]
    async fn where_a_name_leads_is_not_told() {
        let webhooks = Webhooks::default();
        let checked = webhooks.check("http://localhost:9/").await.unwrap_err().to_string();
        let sent = sent(&webhooks, "http://localhost:9/").await.unwrap_err().to_string();
        for said in [checked, sent] {
            assert!(said.contains("`localhost` leads to what is not a public address"), "{said}");
            assert!(!said.contains("127.") && !said.contains("::1"), "{said}");
        }
    }

    #[tokio::test]
    async fn what_is_no_address_of_a_receiver_is_refused() {
        let webhooks = Webhooks::default();
        let long = format!("https://example.com/{}", "a".repeat(2000));
        for url in ["example.com", "ftp://example.com/", "https://me:it@example.com/", "", &long] {
            let checked = webhooks.check(url).await;
            assert!(matches!(checked, Err(SendError::Url { .. })), "{url}: {checked:?}");
        }
    }

    #[tokio::test]
    async fn nobody_listening_is_a_failure_that_says_so() {
        let webhooks = Webhooks::new(Allowed::new(vec!["127.0.0.0/8".parse().unwrap()]));
        // Bound and closed again: nobody listens there.
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let failed = sent(&webhooks, &format!("http://127.0.0.1:{port}/")).await;
        let Err(SendError::Connection(reason)) = failed else { panic!("{failed:?}") };
        assert!(reason.to_lowercase().contains("refused"), "{reason}");
    }
}
