//! What each source of settings says, and which of them counts.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::ConfigError;

/// Where it listens.
pub(super) const LISTEN: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8080);

/// Where the database is.
pub(super) const DATA_DIR: &str = "servoscope-data";

/// Largest upload as sent, mebibytes.
pub(super) const UPLOAD_MIB: usize = 64;

/// Largest upload once unpacked, mebibytes, unless more may be sent.
pub(super) const UNPACKED_MIB: usize = 128;

/// Longest that a job may compute, minutes.
pub(super) const JOB_MINUTES: usize = 360;

/// How long a job stays with a worker that is not heard of, seconds.
pub(super) const LEASE_SECONDS: usize = 10;

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

impl Settings {
    /// What holds where nobody says anything, whatever else is said.
    fn defaults() -> Self {
        Self {
            listen: Some(LISTEN),
            insecure_listen: Some(false),
            data_dir: Some(DATA_DIR.into()),
            max_upload_mib: Some(UPLOAD_MIB),
            workers: Some(std::thread::available_parallelism().map_or(1, NonZeroUsize::get)),
            job_minutes: Some(JOB_MINUTES),
            lease_seconds: Some(LEASE_SECONDS),
            cors_origins: Some(Vec::new()),
            log_format: Some(LogFormat::Text),
            ..Self::default()
        }
    }

    /// These settings, and the defaults of what they do not say; what is still `None` has
    /// no limit.
    pub fn completed(self) -> Self {
        let below = Self::defaults();
        let sent = self.max_upload_mib.or(below.max_upload_mib);
        let max_unpacked_mib = Some(sent.unwrap_or_default().max(UNPACKED_MIB));
        self.over(Self { max_unpacked_mib, ..below })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_source_does_not_say_is_left_to_the_one_below() {
        let file = Settings { workers: Some(1), keep_days: Some(30), ..Settings::default() };
        let flags = Settings { workers: Some(2), ..Settings::default() };
        let both = flags.over(file).completed();
        assert_eq!(
            (both.workers, both.keep_days, both.max_upload_mib),
            (Some(2), Some(30), Some(64))
        );
    }

    #[test]
    fn what_may_be_unpacked_is_no_less_than_what_may_be_sent() {
        for (sent, unpacked) in [(1, 128), (200, 200)] {
            let settings = Settings { max_upload_mib: Some(sent), ..Settings::default() };
            assert_eq!(settings.completed().max_unpacked_mib, Some(unpacked));
        }
    }

    #[test]
    fn an_unknown_key_of_a_file_is_refused_with_its_line() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("servoscope.toml");
        std::fs::write(&file, "workers = 2\nwrokers = 3\n").unwrap();
        let refused = Settings::read(&file).unwrap_err().to_string();
        assert!(refused.contains("line 2") && refused.contains("wrokers"), "{refused}");
    }
}
