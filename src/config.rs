//! What a server is told when it starts: defaults, then a file, then the
//! environment, then flags; each says only what it changes. Checked once.

mod settings;

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

pub use settings::{LogFormat, Settings};

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// The largest upload limit that can be asked for: bodies are held in memory.
const MAX_UPLOAD_MIB: usize = 4096;

/// What a server needs to know, checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServeConfig {
    /// Address to listen on.
    pub listen: SocketAddr,
    /// Directory of the database.
    pub data_dir: PathBuf,
    /// Largest upload as sent, bytes.
    pub max_upload_bytes: usize,
    /// Largest upload once unpacked, bytes.
    pub max_unpacked_bytes: usize,
    /// Largest database, bytes.
    pub max_store_bytes: Option<u64>,
    /// Jobs that run at once.
    pub workers: NonZeroUsize,
    /// Longest that a job may compute.
    pub job_limit: Duration,
    /// How long a job stays out of the queue after its worker was last heard of.
    pub lease: Duration,
    /// How long what is finished is kept; `None`: for ever.
    pub keep: Option<Duration>,
    /// Origins of pages whose scripts may use the service.
    pub cors_origins: Vec<String>,
    /// How log lines are written.
    pub log_format: LogFormat,
}

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
}

impl ServeConfig {
    /// Checks settings; what they do not say takes its default.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn check(settings: Settings) -> Result<Self, ConfigError> {
        let listen = settings.listen.unwrap_or(settings::LISTEN);
        if !listen.ip().is_loopback() && settings.insecure_listen != Some(true) {
            return Err(ConfigError::Open(listen));
        }
        let sent = settings.max_upload_mib.unwrap_or(settings::UPLOAD_MIB);
        let sent = within("max_upload_mib", sent, 1, MAX_UPLOAD_MIB)?;
        let unpacked = settings.max_unpacked_mib.unwrap_or(sent.max(settings::UNPACKED_MIB));
        let unpacked = within("max_unpacked_mib", unpacked, 1, MAX_UPLOAD_MIB)?;
        let store = settings.max_store_mib.map(|size| within("max_store_mib", size, 1, 1 << 30));
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let workers = within("workers", settings.workers.unwrap_or(cores.get()), 1, 1024)?;
        let minutes = settings.job_minutes.unwrap_or(settings::JOB_MINUTES);
        let minutes = within("job_minutes", minutes, 1, 60 * 24 * 366)?;
        // A beat of an overloaded machine may come late by a second.
        let lease = settings.lease_seconds.unwrap_or(settings::LEASE_SECONDS);
        let lease = within("lease_seconds", lease, 2, 3600)?;
        let keep = settings.keep_days.map(|days| within("keep_days", days, 1, 36_600));
        let cors_origins = settings.cors_origins.unwrap_or_default();
        if let Some(wrong) = cors_origins.iter().find(|origin| !is_origin(origin)) {
            return Err(ConfigError::Origin(wrong.clone()));
        }
        let seconds = |seconds: usize| Duration::from_secs(seconds as u64);
        Ok(Self {
            listen,
            data_dir: settings.data_dir.unwrap_or_else(|| settings::DATA_DIR.into()),
            max_upload_bytes: sent * MIB,
            max_unpacked_bytes: unpacked * MIB,
            max_store_bytes: store.transpose()?.map(|mebibytes| (mebibytes * MIB) as u64),
            workers: NonZeroUsize::new(workers).unwrap_or(NonZeroUsize::MIN),
            job_limit: seconds(minutes * 60),
            lease: seconds(lease),
            keep: keep.transpose()?.map(|days| seconds(days * 24 * 3600)),
            cors_origins,
            log_format: settings.log_format.unwrap_or_default(),
        })
    }
}

fn within(
    setting: &'static str,
    value: usize,
    low: usize,
    high: usize,
) -> Result<usize, ConfigError> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(ConfigError::Range { setting, value, low, high })
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
            assert_eq!((config.max_upload_bytes, config.workers.get()), (64 << 20, 3));
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
        let huge = Settings { max_upload_mib: Some(MAX_UPLOAD_MIB + 1), ..loopback };
        assert!(ServeConfig::check(huge).is_err());
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
