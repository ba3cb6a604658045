//! Signals from the terminal and from whoever runs the process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use tokio::signal::unix::{Signal, SignalKind, signal};
use tracing::warn;

/// Exit code of a process ended by an interrupt, by the custom of shells.
const INTERRUPTED: i32 = 130;

/// Sets the flag returned on the first interrupt; the second one ends the process.
pub(super) fn flag() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let interrupted = Arc::clone(&flag);
    let watching = std::thread::Builder::new().name("interrupt".into()).spawn(move || {
        if let Err(error) = watch(&interrupted) {
            warn!(%error, "signals cannot be handled: Ctrl-C will stop the process at once");
        }
    });
    if let Err(error) = watching {
        warn!(%error, "signals cannot be handled: Ctrl-C will stop the process at once");
    }
    flag
}

fn watch(interrupted: &AtomicBool) -> std::io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let mut signals = Terminations::new()?;
        signals.next().await;
        interrupted.store(true, Ordering::Relaxed);
        signals.next().await;
        std::process::exit(INTERRUPTED)
    })
}

/// The signals by which a process is asked to end.
pub(super) struct Terminations {
    interrupt: Signal,
    terminate: Signal,
}

impl Terminations {
    /// Takes over the signals; from now on they do not end the process.
    pub(super) fn new() -> std::io::Result<Self> {
        Ok(Self {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
        })
    }

    /// Completes on the next of them.
    pub(super) async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }
}
