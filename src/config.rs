//! What a server is told when it starts: defaults, then a file, then the
//! environment, then flags; each says only what it changes. Checked once.

mod address;
mod declaration;
mod files;
mod secret;
mod settings;

use std::ops::RangeInclusive;

use crate::notify::{Broker, BrokerError};

pub use address::Address;
pub use secret::SecretText;
pub use settings::{LogFormat, ServeConfig, Settings};

use settings::MAX_BODIES_MIB;

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
    /// Two first admin keys.
    #[error("admin_key, admin_key_file: give one of them, not both")]
    TwoKeys,
    /// No database is there.
    #[error("database: {0} is not an address as in `postgres://user:password@host/name`")]
    Database(Address),
    /// A limit that a Postgres database does not know.
    #[error("max_store_mib: how large a Postgres database may grow is set there; leave it out")]
    StoreLimit,
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
        if settings.admin_key.is_some() && settings.admin_key_file.is_some() {
            return Err(ConfigError::TwoKeys);
        }
        if let Some(database) = &settings.database {
            let address = database.reveal();
            if !["postgres://", "postgresql://"].iter().any(|scheme| address.starts_with(scheme)) {
                return Err(ConfigError::Database(database.clone()));
            }
            if settings.max_store_mib.is_some() {
                return Err(ConfigError::StoreLimit);
            }
        }
        let config = settings.in_range()?;
        // A body is held as it was sent and unpacked: with less, the largest would never be read.
        let low = config.max_upload_mib + config.max_unpacked_mib;
        within("max_bodies_mib", Some(config.max_bodies_mib), low..=MAX_BODIES_MIB)?;
        config.broker()?;
        match config.cors_origins.iter().find(|origin| !is_origin(origin)) {
            Some(wrong) => Err(ConfigError::Origin(wrong.clone())),
            None => Ok(config),
        }
    }

    /// The first admin key, where one is given.
    ///
    /// # Errors
    /// [`ConfigError::File`] where its file cannot be read.
    pub fn first_admin_key(&self) -> Result<Option<SecretText>, ConfigError> {
        let Some(file) = &self.admin_key_file else { return Ok(self.admin_key.clone()) };
        let text = std::fs::read_to_string(file).map_err(|error| ConfigError::File {
            file: file.display().to_string(),
            reason: error.to_string(),
        })?;
        Ok(Some(text.into()))
    }

    /// The broker, where there is one.
    ///
    /// # Errors
    /// [`ConfigError::Broker`], never once the settings are checked.
    pub fn broker(&self) -> Result<Option<Broker>, ConfigError> {
        let parsed = |address: &Address| Broker::parse(address.reveal(), &self.mqtt_topic);
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
    fn what_is_not_given_takes_its_default() {
        let config = ServeConfig::check(settings("127.0.0.1:0")).unwrap();
        assert_eq!((config.max_upload_mib, config.workers), (64, 3));
    }

    #[test]
    fn there_is_memory_for_the_largest_upload() {
        let bodies = |mib| {
            let bodies = Settings { max_bodies_mib: Some(mib), ..settings("127.0.0.1:0") };
            ServeConfig::check(Settings { max_upload_mib: Some(100), ..bodies })
        };
        // As sent, and once unpacked, for which the default is 128.
        assert_eq!(bodies(228).unwrap().max_bodies_mib, 228);
        assert!(bodies(227).unwrap_err().to_string().contains("227 is outside 228 to"));
        let most = Settings { max_upload_mib: Some(4096), ..settings("127.0.0.1:0") };
        assert!(ServeConfig::check(most).is_ok(), "the default follows");
        let absurd = Settings { max_unpacked_mib: Some(usize::MAX / 2), ..settings("127.0.0.1:0") };
        let refused = ServeConfig::check(absurd).unwrap_err().to_string();
        assert!(refused.contains("max_unpacked_mib"), "{refused}");
    }

    #[test]
    fn the_first_admin_key_comes_from_one_place_and_is_not_shown() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("key");
        std::fs::write(&file, "in a file\n").unwrap();
        let filed = Settings { admin_key_file: Some(file.clone()), ..settings("[::1]:0") };
        let given = Settings { admin_key: "given".parse().ok(), ..settings("[::1]:0") };
        let both = filed.clone().over(given.clone());
        let key = |settings| {
            let config = ServeConfig::check(settings).unwrap();
            assert!(!format!("{config:?}").contains("given"));
            config.first_admin_key().map(|key| key.unwrap().reveal().to_owned())
        };
        assert_eq!(key(given), Ok("given".into()));
        assert_eq!(key(filed.clone()), Ok("in a file\n".into()));
        assert_eq!(ServeConfig::check(both), Err(ConfigError::TwoKeys));
        std::fs::remove_file(file).unwrap();
        assert!(key(filed).unwrap_err().to_string().contains("key: "));
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let loopback = settings("127.0.0.1:0");
        let many = Settings { workers: Some(1025), ..loopback.clone() };
        assert!(ServeConfig::check(many).is_err());
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
    fn a_database_that_cannot_be_used_is_refused_without_its_password() {
        for (address, max_store_mib, good) in [
            ("postgres://bench:secret@host/bench", None, true),
            ("postgresql://bench:secret@host/bench", None, true),
            ("mysql://bench:secret@host/bench", None, false),
            ("postgres://bench:secret@host/bench", Some(100), false),
        ] {
            let database = address.parse().ok();
            let checked =
                ServeConfig::check(Settings { database, max_store_mib, ..settings("[::1]:0") });
            assert_eq!(checked.is_ok(), good, "{address}");
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
