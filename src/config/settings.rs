//! Every setting of a server, each declared once.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use ipnet::IpNet;
use serde::{Deserialize, Serialize};

use super::ConfigError;
use super::address::Address;
use super::declaration::settings;
use super::files;
use super::secret::SecretText;

/// Where it listens.
const LISTEN: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8080);

/// Largest upload as sent, mebibytes.
const UPLOAD_MIB: usize = 64;

/// The largest upload limit that can be asked for: bodies are held in memory.
const MAX_UPLOAD_MIB: usize = 4096;

/// The most memory for all bodies together that can be asked for, mebibytes.
pub(super) const MAX_BODIES_MIB: usize = 1 << 24;

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

settings! {
    /// Address to listen on; port 0 takes a free one. Where other machines can reach it, a key is
    /// needed: see `servoscope keys` [default: 127.0.0.1:8080].
    #[arg(long, value_name = "ADDRESS", env = "SERVOSCOPE_LISTEN")]
    listen: SocketAddr = |_| LISTEN;

    /// Directory of the database; made if it is not there [default: servoscope-data].
    #[arg(long, value_name = "DIR", env = "SERVOSCOPE_DATA_DIR")]
    data_dir: PathBuf = |_| "servoscope-data".into();

    /// Postgres database that other servers and workers may share, in place of the one in the
    /// directory, `postgres://user:password@host/name`; other users of the machine see arguments,
    /// so that a password is better put in the environment or the file [default: none].
    #[arg(long, value_name = "URL", env = "SERVOSCOPE_DATABASE", hide_env_values = true)]
    database: Address;

    /// First admin key, as for a container: it is stored at the start unless it is there already.
    /// Other users of the machine see arguments, so that it is better put in the environment or a
    /// file [default: none].
    #[arg(long, value_name = "KEY", env = "SERVOSCOPE_ADMIN_KEY", hide_env_values = true)]
    admin_key: SecretText;

    /// File that has the first admin key [default: none].
    #[arg(long, value_name = "FILE", env = "SERVOSCOPE_ADMIN_KEY_FILE")]
    admin_key_file: PathBuf;

    /// Largest upload as sent, mebibytes [default: 64].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_UPLOAD_MIB")]
    max_upload_mib: usize = |_| UPLOAD_MIB, in 1..=MAX_UPLOAD_MIB;

    /// Largest upload once unpacked, mebibytes [default: 128, or the largest upload
    /// as sent where that is more].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_UNPACKED_MIB")]
    max_unpacked_mib: usize = |given| given.max_upload_mib.unwrap_or(UPLOAD_MIB).max(128),
        in 1..=MAX_UPLOAD_MIB;

    /// Memory for the uploads that are under way together, mebibytes; further uploads are
    /// refused with 503 and `Retry-After` [default: 512, or four times the largest upload once unpacked where that is
    /// more].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_BODIES_MIB")]
    max_bodies_mib: usize = |given| given.max_unpacked_mib
        .or(given.max_upload_mib).unwrap_or(UPLOAD_MIB).saturating_mul(4).max(512), in 1..=MAX_BODIES_MIB;

    /// Largest database, mebibytes [default: as the disk has room].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_MAX_STORE_MIB")]
    max_store_mib: usize, in 1..=1 << 30;

    /// Connections at once [default: as many as the limit of open files leaves room for, 4096 at
    /// most].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_MAX_CONNECTIONS")]
    max_connections: usize = |_| files::connections().min(4096), in 1..=files::connections();

    /// Jobs that run at once; 0 leaves them to other processes, see `servoscope worker`
    /// [default: one per core].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_WORKERS")]
    workers: usize = |_| std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
        in 0..=1024;

    /// Longest that a job may compute, minutes [default: 360].
    #[arg(long, value_name = "MINUTES", env = "SERVOSCOPE_JOB_MINUTES")]
    job_minutes: usize = |_| 360, in 1..=60 * 24 * 366;

    /// Longest that a job may be estimated to take on one processor, minutes; one that would take
    /// longer is refused [default: 60].
    #[arg(long, value_name = "MINUTES", env = "SERVOSCOPE_JOB_COST_MINUTES")]
    job_cost_minutes: usize = |_| 60, in 1..=60 * 24 * 366;

    /// Requests per minute for one key; up to one minute's worth may come at once [default: 6000].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_KEY_REQUESTS_PER_MINUTE")]
    key_requests_per_minute: usize = |_| 6000, in 1..=1_000_000_000;

    /// Measurements that a key may keep [default: no limit].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_KEY_MEASUREMENTS")]
    key_measurements: usize, in 1..=1_000_000_000;

    /// Mebibytes of measurements that a key may keep [default: no limit].
    #[arg(long, value_name = "MIB", env = "SERVOSCOPE_KEY_MIB")]
    key_mib: usize, in 1..=1 << 30;

    /// Jobs of a key that may wait or run [default: no limit].
    #[arg(long, value_name = "N", env = "SERVOSCOPE_KEY_JOBS")]
    key_jobs: usize, in 1..=1_000_000_000;

    /// Minutes that the jobs of a key may run within 24 hours [default: no limit].
    #[arg(long, value_name = "MINUTES", env = "SERVOSCOPE_KEY_COMPUTE_MINUTES")]
    key_compute_minutes: usize, in 1..=1_000_000_000;

    // A beat of an overloaded machine may come late by a second.
    /// Seconds without a sign of life from a worker after which its job is run again
    /// [default: 10].
    #[arg(long, value_name = "SECONDS", env = "SERVOSCOPE_LEASE_SECONDS")]
    lease_seconds: usize = |_| 10, in 2..=3600;

    /// How long a job waits whose worker died a second time, seconds; with each further death it
    /// waits longer [default: 120].
    #[arg(long, value_name = "SECONDS", env = "SERVOSCOPE_RETRY_SECONDS")]
    retry_seconds: usize = |_| 120, in 0..=3600;

    /// Days after which ended jobs, and measurements without jobs, are deleted
    /// [default: never].
    #[arg(long, value_name = "DAYS", env = "SERVOSCOPE_KEEP_DAYS")]
    keep_days: usize, in 1..=36_600;

    /// Name by which the service is reached beside `localhost` and the addresses of the
    /// loopback, as behind a proxy, with its port if that is not the usual one; repeated, or
    /// separated by commas. A key is needed then: see `servoscope keys`. Requests for other names
    /// are refused [default: any name if other machines can reach the server, else none].
    #[arg(long = "host", value_name = "NAME", env = "SERVOSCOPE_HOSTS", value_delimiter = ',')]
    hosts: Vec<String> = |_| Vec::new();

    /// Origin of pages whose scripts may use the service from a browser; repeated,
    /// or separated by commas [default: none].
    #[arg(long = "cors-origin", value_name = "ORIGIN", env = "SERVOSCOPE_CORS_ORIGINS",
          value_delimiter = ',')]
    cors_origins: Vec<String> = |_| Vec::new();

    /// Network that webhooks may be sent to though it is not public, as in `10.1.0.0/16`;
    /// repeated, or separated by commas [default: none].
    #[arg(long, value_name = "CIDR", env = "SERVOSCOPE_WEBHOOK_ALLOW", value_delimiter = ',')]
    webhook_allow: Vec<IpNet> = |_| Vec::new();

    /// MQTT broker that events are published on, `mqtt://user:password@host:1883` or
    /// `mqtts://…`; other users of the machine see arguments, so that a password is better
    /// put in the environment or the file [default: none].
    #[arg(long, value_name = "URL", env = "SERVOSCOPE_MQTT", hide_env_values = true)]
    mqtt: Address;

    /// Beginning of the topics that events are published under [default: servoscope].
    #[arg(long, value_name = "TOPIC", env = "SERVOSCOPE_MQTT_TOPIC")]
    mqtt_topic: String = |_| "servoscope".to_owned();

    /// How log lines are written [default: text].
    #[arg(long, value_name = "FORMAT", env = "SERVOSCOPE_LOG_FORMAT")]
    log_format: LogFormat = |_| LogFormat::Text;
}

impl Settings {
    /// Reads a TOML file of settings.
    ///
    /// # Errors
    /// [`ConfigError::File`] with line, column and what is known.
    pub fn read(file: &Path) -> Result<Self, ConfigError> {
        let wrong = |reason: String| ConfigError::File { file: file.display().to_string(), reason };
        let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
        toml::from_str(&text).map_err(|error| wrong(error.to_string().trim().to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use clap::Args;

    use super::*;

    #[test]
    fn the_help_of_a_setting_ends_with_its_default() {
        let command = Settings::augment_args(clap::Command::new("serve"));
        for (name, default) in Settings::default().completed().entries() {
            let argument = command.get_arguments().find(|argument| argument.get_id() == name);
            let help = argument.unwrap().get_help().unwrap().to_string();
            let default = default.unwrap_or_default();
            let words = match name {
                "max_store_mib" => "as the disk has room",
                "max_connections" => "as many as the limit of open files leaves room for",
                "workers" => "one per core",
                "keep_days" => "never",
                "key_measurements" | "key_mib" | "key_jobs" | "key_compute_minutes" => "no limit",
                "hosts" => "any name if other machines can reach the server, else none",
                "cors_origins" | "webhook_allow" | "mqtt" | "admin_key" | "admin_key_file"
                | "database" => "none",
                _ => default.trim_matches('"'),
            };
            assert!(help.contains(&format!("[default: {words}")), "{name}: {words}: {help}");
        }
    }

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
