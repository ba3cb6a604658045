//! What a server is told when it starts: defaults, then a file, then the
//! environment, then flags; each says only what it changes. Checked once.

mod broker;
mod declaration;
mod settings;

use std::net::SocketAddr;
use std::ops::RangeInclusive;

use crate::notify::{Broker, BrokerError};

pub use broker::BrokerAddress;
pub use settings::{LogFormat, ServeConfig, Settings};

/// A setting that no server can be started with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read, or says something that is not understood.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The address is open to other machines and the service has no lock.
    #[error(
        "{0} can be reached from other machines and the service asks nobody who they are; listen \
         on a loopback address such as 127.0.0.1, or say --insecure-listen if something in front \
         of it does"
    )]
    Open(SocketAddr),
    /// A number is out of range.
    #[error("{setting}: {value} is outside {low} to {high}")]
    Range {
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: usize,
        /// Smallest usable value.
        low: usize,
        /// Largest usable value.
        high: usize,
    },
    /// An origin that no browser sends.
    #[error("cors_origins: `{0}` is not an origin as in `https://bench.example:8443`")]
    Origin(String),
    /// Nothing can be published there.
    #[error("mqtt: {0}")]
    Broker(BrokerError),
}

impl ServeConfig {
    /// Checks settings; what they do not say takes its default.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn check(settings: Settings) -> Result<Self, ConfigError> {
        let settings = settings.completed();
        if let Some(listen) = settings.listen
            && !listen.ip().is_loopback()
            && settings.insecure_listen != Some(true)
        {
            return Err(ConfigError::Open(listen));
        }
        let config = settings.in_range()?;
        config.broker()?;
        match config.cors_origins.iter().find(|origin| !is_origin(origin)) {
            Some(wrong) => Err(ConfigError::Origin(wrong.clone())),
            None => Ok(config),
        }
    }

    /// The broker, where there is one.
    ///
    /// # Errors
    /// [`ConfigError::Broker`], never once the settings are checked.
    pub fn broker(&self) -> Result<Option<Broker>, ConfigError> {
        let parsed = |address: &BrokerAddress| Broker::parse(address.reveal(), &self.mqtt_topic);
        self.mqtt.as_ref().map(parsed).transpose().map_err(ConfigError::Broker)
    }
}

/// Whether the value of a setting, if it has one, is in its range.
fn within(
    setting: &'static str,
    value: Option<usize>,
    range: RangeInclusive<usize>,
) -> Result<(), ConfigError> {
    match value.filter(|value| !range.contains(value)) {
        Some(value) => {
            let (low, high) = range.into_inner();
            Err(ConfigError::Range { setting, value, low, high })
        }
        None => Ok(()),
    }
}

/// Scheme, host and perhaps a port, as browsers send it.
fn is_origin(text: &str) -> bool {
    let host = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    let host = host.unwrap_or_default();
    !host.is_empty() && host.chars().all(|c| c.is_ascii_alphanumeric() || ".-:[]".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(listen: &str) -> Settings {
        Settings { listen: Some(listen.parse().unwrap()), workers: Some(3), ..Settings::default() }
    }

    #[test]
    fn a_loopback_address_needs_no_consent() {
        for listen in ["127.0.0.1:0", "[::1]:8080"] {
            let config = ServeConfig::check(settings(listen)).unwrap();
            assert_eq!((config.max_upload_mib, config.workers), (64, 3));
        }
    }

    #[test]
    fn an_open_address_needs_consent() {
        for listen in ["0.0.0.0:8080", "[::]:8080", "192.168.0.1:80"] {
            let refused = ServeConfig::check(settings(listen)).unwrap_err();
            assert!(matches!(refused, ConfigError::Open(_)), "{refused}");
            let consent = Settings { insecure_listen: Some(true), ..settings(listen) };
            assert!(ServeConfig::check(consent).is_ok());
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let loopback = settings("127.0.0.1:0");
        let none = Settings { workers: Some(0), ..loopback.clone() };
        assert!(ServeConfig::check(none).is_err());
        let huge = Settings { max_upload_mib: Some(4097), ..loopback };
        assert!(ServeConfig::check(huge).is_err());
    }

    #[test]
    fn a_broker_that_cannot_be_used_is_refused_without_its_password() {
        for (address, topic, good) in [
            ("mqtt://bench:secret@host", "plant/7", true),
            ("http://bench:secret@host", "plant", false),
            ("mqtt://bench:secret@host", "plant/#", false),
            ("mqtt://bench:secret@host", "", false),
        ] {
            let (mqtt, mqtt_topic) = (address.parse().ok(), Some(topic.to_owned()));
            let checked = ServeConfig::check(Settings { mqtt, mqtt_topic, ..settings("[::1]:0") });
            assert_eq!(checked.is_ok(), good, "{address} {topic}");
            assert!(!format!("{checked:?}").contains("secret"));
        }
    }

    #[test]
    fn an_origin_has_a_scheme_and_no_path() {
        for (text, good) in [
            ("https://bench.example:8443", true),
            ("http://127.0.0.1:3000", true),
            ("bench.example", false),
            ("https://bench.example/", false),
            ("*", false),
        ] {
            let cors_origins = Some(vec![text.to_owned()]);
            let settings = Settings { cors_origins, ..settings("127.0.0.1:0") };
            assert_eq!(ServeConfig::check(settings).is_ok(), good, "{text}");
        }
    }
}
