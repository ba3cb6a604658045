//! Publishing on an MQTT broker (3.1.1).

use std::borrow::Cow;
use std::time::Duration;

use percent_encoding::percent_decode_str;
use reqwest::Url;
use rumqttc::{
    AsyncClient, ConnectionError, Event, Incoming, MqttOptions, Outgoing, PublishOptions, QoS,
    Transport,
};

use super::{PATIENCE, SendError, tls};

/// How long taking leave of a broker may take.
const FAREWELL: Duration = Duration::from_secs(1);

/// Why there is no broker at an address. It does not repeat the address, which may hold a
/// password.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BrokerError {
    /// It is not the address of a broker.
    #[error("it is not a URL as in `mqtt://user:password@host:1883` or `mqtts://host`")]
    Url,
    /// The address says more than where the broker is.
    #[error("a path, a `?` or a `#` behind host and port means nothing here")]
    Path,
    /// A password alone.
    #[error("there is a password and no user")]
    User,
    /// The user or the password holds bytes that are no text.
    #[error("the user and the password are UTF-8, their special characters written as `%40`")]
    Text,
    /// Topics cannot begin like this.
    #[error("topics begin with a name such as `servoscope`, without `+`, `#` or a null")]
    Topic,
}

/// A broker, and the beginning of the topics that are published there.
#[derive(Clone)]
pub struct Broker {
    host: String,
    port: u16,
    tls: bool,
    /// User and password.
    credentials: Option<(String, String)>,
    prefix: String,
}

impl Broker {
    /// Reads `mqtt://user:password@host:port`, or `mqtts://` for TLS; the ports are 1883 and
    /// 8883 where it does not say.
    ///
    /// # Errors
    /// What is wrong with the address.
    pub fn parse(address: &str, prefix: &str) -> Result<Self, BrokerError> {
        let url = Url::parse(address).map_err(|_| BrokerError::Url)?;
        let tls = match url.scheme() {
            "mqtt" => false,
            "mqtts" => true,
            _ => return Err(BrokerError::Url),
        };
        let host = url.host_str().filter(|host| !host.is_empty()).ok_or(BrokerError::Url)?;
        if !matches!(url.path(), "" | "/") || url.query().is_some() || url.fragment().is_some() {
            return Err(BrokerError::Path);
        }
        if prefix.is_empty() || prefix.contains(['+', '#', '\0']) {
            return Err(BrokerError::Topic);
        }
        if url.username().is_empty() && url.password().is_some() {
            return Err(BrokerError::User);
        }
        let user = unescaped(url.username()).ok_or(BrokerError::Text)?;
        let password = unescaped(url.password().unwrap_or_default()).ok_or(BrokerError::Text)?;
        Ok(Self {
            host: host.trim_matches(['[', ']']).to_owned(),
            port: url.port().unwrap_or(if tls { 8883 } else { 1883 }),
            tls,
            credentials: (!user.is_empty()).then_some((user, password)),
            prefix: prefix.to_owned(),
        })
    }

    /// Publishes a message below the prefix, and returns once the broker has taken it (QoS 1).
    ///
    /// There are a few messages an hour: a connection of its own for each needs no looking
    /// after between them.
    ///
    /// # Errors
    /// Why the broker did not take it.
    pub async fn publish(&self, topic: &str, body: &str) -> Result<(), SendError> {
        match tokio::time::timeout(PATIENCE, self.published(topic, body)).await {
            Ok(published) => published,
            Err(_) => Err(SendError::TimedOut),
        }
    }

    async fn published(&self, topic: &str, body: &str) -> Result<(), SendError> {
        let refused = |error: &dyn std::fmt::Display| SendError::Broker(error.to_string());
        let (client, mut connection) = AsyncClient::builder(self.options())
            .capacity(2)
            .try_build()
            .map_err(|e| refused(&e))?;
        let topic = format!("{}/{topic}", self.prefix);
        let options = PublishOptions::new(QoS::AtLeastOnce);
        client.publish(topic, body.to_owned(), options).await.map_err(|error| refused(&error))?;
        // Nothing else is under way that it could acknowledge.
        while !matches!(
            connection.poll().await.map_err(|error| failure(&error))?,
            Event::Incoming(Incoming::PubAck(_))
        ) {}
        // It has taken the message; that the farewell arrives is not needed.
        if client.disconnect().await.is_ok() {
            let farewell = async {
                while !matches!(
                    connection.poll().await,
                    Ok(Event::Outgoing(Outgoing::Disconnect)) | Err(_)
                ) {}
            };
            let _ = tokio::time::timeout(FAREWELL, farewell).await;
        }
        Ok(())
    }

    fn options(&self) -> MqttOptions {
        // Two connections with one name would end each other; a name has 23 characters.
        let id = uuid::Uuid::now_v7().simple().to_string();
        let mut options =
            MqttOptions::new(format!("servoscope-{}", &id[20..]), (self.host.clone(), self.port));
        if let Some((user, password)) = &self.credentials {
            options.set_credentials(user.clone(), password.clone());
        }
        if self.tls {
            options.set_transport(Transport::tls_with_config(tls::config().into()));
        }
        options
    }
}

fn failure(error: &ConnectionError) -> SendError {
    match error {
        ConnectionError::Io(error) => SendError::Connection(error.to_string()),
        ConnectionError::Tls(error) => SendError::Connection(error.to_string()),
        ConnectionError::ConnectionRefused(code) => SendError::Broker(format!("{code:?}")),
        other => SendError::Broker(other.to_string()),
    }
}

/// Undoes `%40` and the like.
fn unescaped(text: &str) -> Option<String> {
    percent_decode_str(text).decode_utf8().ok().map(Cow::into_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(address: &str) -> Result<Broker, BrokerError> {
        Broker::parse(address, "servoscope")
    }

    #[test]
    fn an_address_says_host_port_user_and_password() {
        let broker = parsed("mqtt://bench:p%40ss%3Aw@broker.example:1884").unwrap();
        assert_eq!(
            (broker.host.as_str(), broker.port, broker.tls),
            ("broker.example", 1884, false)
        );
        assert_eq!(broker.credentials, Some(("bench".into(), "p@ss:w".into())));
        let broker = parsed("mqtts://[fd12::1]/").unwrap();
        assert_eq!((broker.host.as_str(), broker.port, broker.tls), ("fd12::1", 8883, true));
        assert_eq!((broker.credentials, parsed("mqtt://host").unwrap().port), (None, 1883));
    }

    #[test]
    fn what_is_wrong_with_an_address_is_said_without_its_password() {
        for (address, wrong) in [
            ("http://me:secret@host", BrokerError::Url),
            ("mqtt://", BrokerError::Url),
            ("me:secret@host", BrokerError::Url),
            ("mqtt://me:secret@host/topic", BrokerError::Path),
            ("mqtt://:secret@host", BrokerError::User),
            ("mqtt://me:%ff@host", BrokerError::Text),
        ] {
            let refused = parsed(address).err().expect(address);
            assert_eq!(refused, wrong, "{address}");
            assert!(!refused.to_string().contains("secret"));
        }
    }
}
