//! Logging of a process: to standard error, so that standard output is the answer.

use std::io::IsTerminal;

use tracing_subscriber::EnvFilter;

use crate::config::LogFormat;

/// Starts to log what `RUST_LOG` says, or `level`, or more where it is asked for.
pub(super) fn start(level: &str, verbose: u8, format: LogFormat) {
    let default = match verbose {
        0 => level,
        // The database says every statement at this level.
        1 => "debug,sqlx=info",
        _ => "trace",
    };
    let filter = match std::env::var(EnvFilter::DEFAULT_ENV) {
        Ok(text) if verbose == 0 => EnvFilter::new(text),
        _ => EnvFilter::new(default),
    };
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    match format {
        LogFormat::Text => log.with_ansi(std::io::stderr().is_terminal()).init(),
        LogFormat::Json => log.json().flatten_event(true).init(),
    }
}
