//! What a server is told when it starts: defaults, then a file, then the
//! environment, then flags; each says only what it changes. Checked once.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// The largest upload limit that can be asked for: bodies are held in memory.
const MAX_UPLOAD_MIB: usize = 4096;

/// How a log line is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// For a person.
    #[default]
    Text,
    /// One JSON object a line, for a program.
    Json,
}

/// What one source says; `None` where it says nothing.
///
/// The same list is the flags and environment variables of `serve` and
/// `config show`, and the keys of the file.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, clap::Args)]
#[serde(deny_unknown_fields)]
#[group(skip)]
pub struct Settings {
    /// Address to listen on; port 0 takes a free one [default: 127.0.0.1:8080].
    #[arg(long, value_name = "ADDRESS", env = "SERVOSCOPE_LISTEN")]
    pub listen: Option<SocketAddr>,
    /// Allows an address that other machines can reach. The service asks nobody
    /// who they are: something in front of it must.
    #[arg(long, env = "SERVOSCOPE_INSECURE_LISTEN", num_args = 0..=1, require_equals = true,
          default_missing_value = "true", value_name = "BOOL")]
    pub insecure_listen: Option<bool>,
    /// Directory of the database; made if it is not there [default: servoscope-data].
    #[arg(long, value_name = "DIR", env = "SERVOSCOPE_DATA_DIR")]
    pub data_dir: Option<PathBuf>,
    /// Largest upload as sent, mebibytes [default: 64].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_UPLOAD_MIB")]
    pub max_upload_mib: Option<usize>,
    /// Largest upload once unpacked, mebibytes [default: 128, or the largest upload
    /// as sent where that is more].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_UNPACKED_MIB")]
    pub max_unpacked_mib: Option<usize>,
    /// Largest database, mebibytes [default: as the disk has room].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_STORE_MIB")]
    pub max_store_mib: Option<usize>,
    /// Jobs that run at once [default: one a core].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_WORKERS")]
    pub workers: Option<usize>,
    /// Longest that a job may compute, minutes [default: 360].
    #[arg(long, value_name = "MINUTES", env = "SERVOSCOPE_JOB_MINUTES")]
    pub job_minutes: Option<usize>,
    /// How long after its worker was last heard of a job runs again, seconds
    /// [default: 10].
    #[arg(long, value_name = "SECONDS", env = "SERVOSCOPE_LEASE_SECONDS")]
    pub lease_seconds: Option<usize>,
    /// Days after which ended jobs, and measurements without jobs, are deleted
    /// [default: never].
    #[arg(long, value_name = "DAYS", env = "SERVOSCOPE_KEEP_DAYS")]
    pub keep_days: Option<usize>,
    /// Origin of pages whose scripts may use the service from a browser; repeated,
    /// or separated by commas [default: none].
    #[arg(
        long = "cors-origin",
        value_name = "ORIGIN",
        env = "SERVOSCOPE_CORS_ORIGINS",
        value_delimiter = ','
    )]
    pub cors_origins: Option<Vec<String>>,
    /// How log lines are written [default: text].
    #[arg(long, value_name = "FORMAT", env = "SERVOSCOPE_LOG_FORMAT")]
    pub log_format: Option<LogFormat>,
}

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

impl Settings {
    /// What holds where nobody says anything; what is still `None` has no fixed
    /// default.
    pub fn defaults() -> Self {
        Self {
            listen: Some(SocketAddr::from(([127, 0, 0, 1], 8080))),
            insecure_listen: Some(false),
            data_dir: Some("servoscope-data".into()),
            max_upload_mib: Some(64),
            job_minutes: Some(360),
            lease_seconds: Some(10),
            cors_origins: Some(Vec::new()),
            log_format: Some(LogFormat::Text),
            ..Self::default()
        }
    }

    /// Reads a TOML file of settings.
    ///
    /// # Errors
    /// [`ConfigError::File`] with line, column and what is known.
    pub fn read(file: &Path) -> Result<Self, ConfigError> {
        let wrong = |reason: String| ConfigError::File { file: file.display().to_string(), reason };
        let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
        toml::from_str(&text).map_err(|error| wrong(error.to_string().trim().to_owned()))
    }

    /// These settings, and of `below` what they do not say.
    pub fn over(self, below: Self) -> Self {
        Self {
            listen: self.listen.or(below.listen),
            insecure_listen: self.insecure_listen.or(below.insecure_listen),
            data_dir: self.data_dir.or(below.data_dir),
            max_upload_mib: self.max_upload_mib.or(below.max_upload_mib),
            max_unpacked_mib: self.max_unpacked_mib.or(below.max_unpacked_mib),
            max_store_mib: self.max_store_mib.or(below.max_store_mib),
            workers: self.workers.or(below.workers),
            job_minutes: self.job_minutes.or(below.job_minutes),
            lease_seconds: self.lease_seconds.or(below.lease_seconds),
            keep_days: self.keep_days.or(below.keep_days),
            cors_origins: self.cors_origins.or(below.cors_origins),
            log_format: self.log_format.or(below.log_format),
        }
    }

    /// Names and values, the latter as TOML; `None` where nothing is said.
    pub fn entries(&self) -> Vec<(&'static str, Option<String>)> {
        fn text<T: Serialize>(value: Option<&T>) -> Option<String> {
            let value = toml::Value::try_from(value?).ok()?;
            Some(value.to_string())
        }
        vec![
            ("listen", text(self.listen.as_ref())),
            ("insecure_listen", text(self.insecure_listen.as_ref())),
            ("data_dir", text(self.data_dir.as_ref())),
            ("max_upload_mib", text(self.max_upload_mib.as_ref())),
            ("max_unpacked_mib", text(self.max_unpacked_mib.as_ref())),
            ("max_store_mib", text(self.max_store_mib.as_ref())),
            ("workers", text(self.workers.as_ref())),
            ("job_minutes", text(self.job_minutes.as_ref())),
            ("lease_seconds", text(self.lease_seconds.as_ref())),
            ("keep_days", text(self.keep_days.as_ref())),
            ("cors_origins", text(self.cors_origins.as_ref())),
            ("log_format", text(self.log_format.as_ref())),
        ]
    }
}

impl ServeConfig {
    /// Checks settings; what they do not say takes its default.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn check(settings: Settings) -> Result<Self, ConfigError> {
        let settings = settings.over(Settings::defaults());
        let listen = settings.listen.unwrap_or(SocketAddr::from(([127, 0, 0, 1], 8080)));
        if !listen.ip().is_loopback() && settings.insecure_listen != Some(true) {
            return Err(ConfigError::Open(listen));
        }
        let within = |setting, value: Option<usize>, low, high| match value {
            Some(value) if !(low..=high).contains(&value) => {
                Err(ConfigError::Range { setting, value, low, high })
            }
            value => Ok(value),
        };
        let seconds = |seconds: usize| Duration::from_secs(seconds as u64);
        let sent = within("max_upload_mib", settings.max_upload_mib, 1, MAX_UPLOAD_MIB)?;
        let sent = sent.unwrap_or(64);
        let unpacked = within("max_unpacked_mib", settings.max_unpacked_mib, 1, MAX_UPLOAD_MIB)?;
        let store = within("max_store_mib", settings.max_store_mib, 1, 1 << 30)?;
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let workers = within("workers", settings.workers, 1, 1024)?.unwrap_or(cores.get());
        let minutes = within("job_minutes", settings.job_minutes, 1, 60 * 24 * 366)?;
        // A beat of an overloaded machine may come late by a second.
        let lease = within("lease_seconds", settings.lease_seconds, 2, 3600)?;
        let keep = within("keep_days", settings.keep_days, 1, 36_600)?;
        let cors_origins = settings.cors_origins.unwrap_or_default();
        if let Some(wrong) = cors_origins.iter().find(|origin| !is_origin(origin)) {
            return Err(ConfigError::Origin(wrong.clone()));
        }
        Ok(Self {
            listen,
            data_dir: settings.data_dir.unwrap_or_default(),
            max_upload_bytes: sent * MIB,
            max_unpacked_bytes: unpacked.unwrap_or(sent.max(128)) * MIB,
            max_store_bytes: store.map(|mebibytes| (mebibytes * MIB) as u64),
            workers: NonZeroUsize::new(workers).unwrap_or(NonZeroUsize::MIN),
            job_limit: seconds(minutes.unwrap_or(360) * 60),
            lease: seconds(lease.unwrap_or(10)),
            keep: keep.map(|days| seconds(days * 24 * 3600)),
            cors_origins,
            log_format: settings.log_format.unwrap_or_default(),
        })
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
    fn what_a_source_does_not_say_is_left_to_the_one_below() {
        let file = Settings { workers: Some(1), keep_days: Some(30), ..Settings::default() };
        let flags = Settings { workers: Some(2), ..Settings::default() };
        let both = flags.over(file).over(Settings::defaults());
        assert_eq!(
            (both.workers, both.keep_days, both.max_upload_mib),
            (Some(2), Some(30), Some(64))
        );
    }

    #[test]
    fn an_unknown_key_of_a_file_is_refused_with_its_line() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("servoscope.toml");
        std::fs::write(&file, "workers = 2\nwrokers = 3\n").unwrap();
        let refused = Settings::read(&file).unwrap_err().to_string();
        assert!(refused.contains("line 2") && refused.contains("wrokers"), "{refused}");
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
