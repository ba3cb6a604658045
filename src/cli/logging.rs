//! Logging of a process: to standard error, so that standard output is the answer.

use std::io::IsTerminal;

use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::layer;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

use crate::config::LogFormat;

/// Starts to log what `RUST_LOG` says, or `level`, or more where it is asked for.
pub(super) fn start(level: &str, verbose: u8, format: LogFormat) {
    let default = match verbose {
        0 => level,
        // The database says every statement at this level.
        1 => "debug,sqlx=info",
        _ => "trace",
    };
    let asked = std::env::var("RUST_LOG").ok().filter(|_| verbose == 0);
    let filter = |text: &str| {
        text.parse::<Targets>().unwrap_or_else(|error| {
            eprintln!("`{text}` does not say what to log ({error}); `info` is logged");
            Targets::new().with_default(tracing::Level::INFO)
        })
    };
    let log = tracing_subscriber::registry().with(filter(asked.as_deref().unwrap_or(default)));
    let lines = layer().with_writer(std::io::stderr);
    match format {
        LogFormat::Text => log.with(lines.with_ansi(std::io::stderr().is_terminal())).init(),
        LogFormat::Json => log.with(lines.json().flatten_event(true)).init(),
    }
}
