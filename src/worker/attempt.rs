//! One lease of one job, from its start to whatever ends it.

use std::sync::Arc;
use std::time::Duration;

use servoscope_core::answers::Progress;
use tokio::time::MissedTickBehavior;
use tracing::{error, info, warn};

use crate::service::{Failure, RunError};
use crate::store::{Beat, ConvergencePoint, Lease, Outcome};

use super::Shared;
use super::threads::{self, Ended};
use super::watch::Watch;

/// How long a job whose files cannot be read is kept from the queue.
const PAUSE: Duration = Duration::from_secs(1);

/// A job in the hands of this worker.
pub(super) struct Attempt {
    pub(super) shared: Arc<Shared>,
    pub(super) lease: Lease,
    pub(super) watch: Arc<Watch>,
    /// Rows that no heartbeat has stored yet.
    pub(super) unsent: Vec<ConvergencePoint>,
    /// Progress that no heartbeat has stored yet.
    pub(super) unsent_progress: Option<Progress>,
    /// Storing the outcome has failed, and may have been done all the same: its answer was lost.
    pub(super) tried: bool,
    /// The computation took longer than it may.
    timed_out: bool,
}

/// Runs a leased job to its end, or until it is no longer this worker's.
pub(super) async fn run(shared: Arc<Shared>, lease: Lease) {
    info!("job begins");
    let attempt = Attempt::new(shared, lease);
    attempt.shared.signals.job_changed();
    let Lease { measurement_id, request, .. } = &attempt.lease;
    let files = match attempt.shared.service.job_files(measurement_id, request).await {
        Ok(files) => files,
        Err(error) => return attempt.hand_back_later(&error).await,
    };
    let computing = threads::spawn({
        let service = attempt.shared.service.clone();
        let request = attempt.lease.request.clone();
        let watch = Arc::clone(&attempt.watch);
        move || service.run(&files, &request, watch.as_ref())
    });
    match computing {
        Ok(computing) => attempt.follow(computing).await,
        Err(error) => attempt.hand_back_later(&error).await,
    }
}

impl Attempt {
    pub(super) fn new(shared: Arc<Shared>, lease: Lease) -> Self {
        let watch = Arc::new(Watch::new(lease.next_seq));
        let (unsent, unsent_progress) = (Vec::new(), None);
        Self { shared, lease, watch, unsent, unsent_progress, tried: false, timed_out: false }
    }

    /// Looks after the computation until it ends, is lost, or the process stops.
    async fn follow(
        mut self,
        mut computing: tokio::sync::oneshot::Receiver<Ended<Result<String, RunError>>>,
    ) {
        let shared = Arc::clone(&self.shared);
        let mut stopped = std::pin::pin!(shared.signals.stopped());
        let mut ticks = tokio::time::interval(shared.settings.beat);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut limit = std::pin::pin!(tokio::time::sleep(shared.settings.limit));
        loop {
            tokio::select! {
                ended = &mut computing => {
                    // The sender is dropped only after it was used.
                    let Ok(ended) = ended else { return };
                    let outcome = self.outcome(ended);
                    return self.finish(outcome).await;
                }
                () = &mut stopped => {
                    // The thread ends at its next evaluation, or with the process.
                    self.watch.cancel();
                    return self.hand_back(&"the process stops").await;
                }
                () = &mut limit, if !self.timed_out => {
                    self.timed_out = true;
                    self.watch.cancel();
                }
                () = shared.signals.unwanted() => ticks.reset_immediately(),
                _ = ticks.tick() => match self.beat().await {
                    Ok(Beat::Renewed { cancel_requested: false }) => {}
                    Ok(Beat::Renewed { cancel_requested: true }) => self.watch.cancel(),
                    Ok(Beat::Lost) => {
                        warn!("lease lost; its result is given up");
                        return self.watch.cancel();
                    }
                    Err(error) => warn!(%error, "heartbeat failed"),
                },
            }
        }
    }

    fn outcome(&self, ended: Ended<Result<String, RunError>>) -> Outcome {
        let failed = |reason: String, reference: Option<String>| {
            let failure = serde_json::json!(Failure { reason, reference });
            Outcome::Failed(failure.to_string())
        };
        match ended {
            Ok(Ok(result)) => Outcome::Succeeded(result),
            Ok(Err(RunError::Cancelled)) if self.timed_out => {
                let minutes = self.shared.settings.limit.as_secs_f64() / 60.0;
                failed(format!("it ran longer than the {minutes} minutes it may"), None)
            }
            Ok(Err(RunError::Cancelled)) => Outcome::Cancelled,
            Ok(Err(error)) => failed(error.to_string(), None),
            Err(panic) => {
                let reference = uuid::Uuid::now_v7().to_string();
                let text = threads::panic_text(panic.as_ref());
                error!(reference, text, "the computation panicked");
                let reason = "an internal error stopped the computation; the same request will \
                              most likely fail again. Please report the reference";
                failed(reason.into(), Some(reference))
            }
        }
    }

    /// Handed back at once it would be taken again at once, for as long as the store fails or no
    /// thread can be started.
    async fn hand_back_later(self, reason: &(dyn std::fmt::Display + Sync)) {
        let stopped = self.shared.signals.stopped();
        let _ = tokio::time::timeout(PAUSE, stopped).await;
        self.hand_back(reason).await;
    }
}
