//! What a server is told when it starts, checked once.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// The largest upload limit that can be asked for: bodies are held in memory.
const MAX_UPLOAD_MIB: usize = 4096;

/// What a server is told when it starts, unchecked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServeSettings {
    /// Address to listen on.
    pub listen: SocketAddr,
    /// Whether anybody who reaches that address may use the service.
    pub insecure_listen: bool,
    /// Directory of the database.
    pub data_dir: PathBuf,
    /// Largest upload, mebibytes.
    pub max_upload_mib: usize,
    /// Jobs that run at once; `None`: one a core.
    pub workers: Option<usize>,
}

/// What a server needs to know, checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServeConfig {
    /// Address to listen on.
    pub listen: SocketAddr,
    /// Directory of the database.
    pub data_dir: PathBuf,
    /// Largest upload, bytes.
    pub max_upload_bytes: usize,
    /// Jobs that run at once.
    pub workers: NonZeroUsize,
}

/// A setting that no server can be started with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
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
}

impl ServeConfig {
    /// Checks settings.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn check(settings: ServeSettings) -> Result<Self, ConfigError> {
        if !settings.listen.ip().is_loopback() && !settings.insecure_listen {
            return Err(ConfigError::Open(settings.listen));
        }
        let within = |setting, value, low, high| match (low..=high).contains(&value) {
            true => Ok(value),
            false => Err(ConfigError::Range { setting, value, low, high }),
        };
        let mebibytes = within("--max-upload-mib", settings.max_upload_mib, 1, MAX_UPLOAD_MIB)?;
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let workers = match settings.workers {
            Some(workers) => within("--workers", workers, 1, 1024)?,
            None => cores.get(),
        };
        Ok(Self {
            listen: settings.listen,
            data_dir: settings.data_dir,
            max_upload_bytes: mebibytes * MIB,
            workers: NonZeroUsize::new(workers).unwrap_or(NonZeroUsize::MIN),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(listen: &str) -> ServeSettings {
        ServeSettings {
            listen: listen.parse().unwrap(),
            insecure_listen: false,
            data_dir: "data".into(),
            max_upload_mib: 64,
            workers: Some(3),
        }
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
            let consent = ServeSettings { insecure_listen: true, ..settings(listen) };
            assert!(ServeConfig::check(consent).is_ok());
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let loopback = settings("127.0.0.1:0");
        let none = ServeSettings { workers: Some(0), ..loopback.clone() };
        assert!(ServeConfig::check(none).is_err());
        let huge = ServeSettings { max_upload_mib: MAX_UPLOAD_MIB + 1, ..loopback };
        assert!(ServeConfig::check(huge).is_err());
    }
}
