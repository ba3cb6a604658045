//! Logging of a process: to standard error, so that standard output is the answer.

use std::io::IsTerminal;

use tracing_subscriber::EnvFilter;

/// Starts to log what `RUST_LOG` says, or `level`, or more where it is asked for.
pub(super) fn start(level: &str, verbose: u8) {
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
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .init();
}
