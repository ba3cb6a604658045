//! Runs queued jobs on threads of their own.
//!
//! ```text
//!   store ──lease──▶ attempt ──starts──▶ compute thread
//!     ▲                │  ▲                   │
//!     └───heartbeat────┘  └── watch ◀─────────┘
//! ```
//!
//! One asynchronous task looks after the queue and one after each leased job; the
//! computation itself never runs on a thread of the runtime. Every
//! [`Settings::beat`] the job's task renews the lease, stores what the
//! computation has reported and learns whether it is still wanted.

mod attempt;
mod messages;
mod refused;
mod relay;
mod retention;
#[cfg(test)]
mod tests;
mod threads;
mod watch;
mod writing;

use std::sync::Arc;
use std::time::Duration;

use tokio::task::{JoinHandle, JoinSet};
use tracing::{Instrument, error, info_span, warn};

use crate::service::{Service, Signals};
use crate::store::{Recovered, Store, StoreError};

pub use messages::tell;
pub use relay::relay;
pub use retention::forget;

/// How often the queue is looked at without a signal: other processes may have
/// filled it, or left an expired lease behind.
const LOOK_AGAIN: Duration = Duration::from_secs(2);

/// How long the queue may take to answer. A job that it gives away after that has no worker, and runs
/// again when its lease expires: far more than a database needs that is not cut off.
const PATIENCE: Duration = Duration::from_secs(60);

/// How jobs are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Jobs that run at once.
    pub slots: usize,
    /// How long a job stays out of the queue after its worker was last heard of.
    pub lease: Duration,
    /// How often a job's task reports, renews and asks.
    pub beat: Duration,
    /// How long a job is kept from the queue after the second death of its worker; the wait grows
    /// with each further one.
    pub wait: Duration,
    /// How long one attempt may compute; after that the job fails.
    pub limit: Duration,
}

impl Settings {
    /// Runs `slots` jobs at once.
    pub fn new(slots: usize) -> Self {
        // Fifty beats to a lease: a machine must be quite overloaded to lose one,
        // and a job whose process was killed runs again ten seconds later.
        Self {
            slots,
            lease: Duration::from_secs(10),
            beat: Duration::from_millis(200),
            // Two such waits, the second four times as long, outlast a machine that restarts.
            wait: Duration::from_secs(120),
            limit: Duration::from_secs(6 * 3600),
        }
    }
}

/// What every part of the worker needs.
struct Shared {
    /// Tells this process from others that share the store.
    id: String,
    store: Arc<dyn Store>,
    service: Service,
    signals: Arc<Signals>,
    settings: Settings,
}

impl Shared {
    /// What the store says of a job in hand. A connection that is cut off without a word would keep its
    /// caller waiting for a quarter of an hour: after a third of a lease there is still time to try again.
    async fn answer<T>(
        &self,
        asked: impl Future<Output = Result<T, StoreError>>,
    ) -> Result<T, StoreError> {
        within(self.settings.lease / 3, asked).await
    }
}

async fn within<T>(
    patience: Duration,
    asked: impl Future<Output = Result<T, StoreError>>,
) -> Result<T, StoreError> {
    tokio::time::timeout(patience, asked).await.unwrap_or(Err(StoreError::Silent))
}

/// Starts to run jobs until `signals` say that the process stops; then hands the
/// running ones back and ends.
pub fn start(
    store: Arc<dyn Store>,
    service: Service,
    signals: Arc<Signals>,
    settings: Settings,
) -> JoinHandle<()> {
    threads::prepare();
    let id = uuid::Uuid::now_v7().to_string();
    tokio::spawn(run(Arc::new(Shared { id, store, service, signals, settings })))
}

async fn run(shared: Arc<Shared>) {
    let mut running = JoinSet::new();
    let mut stopped = std::pin::pin!(shared.signals.stopped());
    // What is handed back while the process stops is left to others, and to the next start.
    while !shared.signals.is_stopping() {
        recover(&shared).await;
        while running.len() < shared.settings.slots && !shared.signals.is_stopping() {
            let lease = shared.store.lease(&shared.id, shared.settings.lease);
            match within(PATIENCE, lease).await {
                Ok(Some(lease)) => {
                    let span = info_span!("job", job = lease.job_id, attempt = lease.attempt);
                    running.spawn(attempt::run(Arc::clone(&shared), lease).instrument(span));
                }
                Ok(None) => break,
                Err(error) => {
                    error!(%error, "the queue cannot be read");
                    break;
                }
            }
        }
        tokio::select! {
            () = &mut stopped => {}
            () = shared.signals.queued() => {}
            Some(ended) = running.join_next() => report(ended),
            () = tokio::time::sleep(LOOK_AGAIN) => {}
        }
    }
    while let Some(ended) = running.join_next().await {
        report(ended);
    }
}

async fn recover(shared: &Shared) {
    match within(PATIENCE, shared.store.recover_expired(shared.settings.wait)).await {
        Ok(Recovered { requeued: 0, ended }) if ended.is_empty() => {}
        Ok(Recovered { requeued, ended }) => {
            let metrics = shared.service.metrics();
            for job in &ended {
                metrics.job_ended(&job.kind, job.status, None);
            }
            let ended = ended.len() as u64;
            warn!(requeued, ended, "leases had expired: a worker was killed or cut off");
            metrics.leases_expired(requeued + ended);
            shared.signals.job_ended();
        }
        Err(error) => error!(%error, "expired leases cannot be looked for"),
    }
}

fn report(ended: Result<(), tokio::task::JoinError>) {
    match ended {
        Ok(()) => {}
        // The lease expires and the job is queued again.
        Err(error) => error!(%error, "the task that looks after a job ended badly"),
    }
}
