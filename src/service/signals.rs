//! Wake-up calls within one process, so that nobody waits for a poll.

use tokio::sync::futures::Notified;
use tokio::sync::{Notify, watch};

/// Wake-up calls between the service and the worker of the same process.
///
/// They only shorten waits: other processes share the database but not these, so
/// whoever waits also looks at the store now and then.
#[derive(Debug)]
pub struct Signals {
    queued: Notify,
    ended: Notify,
    changed: Notify,
    cancelling: Notify,
    stopping: watch::Sender<bool>,
}

impl Default for Signals {
    fn default() -> Self {
        Self {
            queued: Notify::new(),
            ended: Notify::new(),
            changed: Notify::new(),
            cancelling: Notify::new(),
            stopping: watch::Sender::new(false),
        }
    }
}

impl Signals {
    /// A job waits for a worker.
    pub fn job_queued(&self) {
        self.queued.notify_one();
    }

    /// Completes once a job waits for a worker.
    pub fn queued(&self) -> Notified<'_> {
        self.queued.notified()
    }

    /// A job has ended, or is gone.
    pub fn job_ended(&self) {
        self.ended.notify_waiters();
        self.changed.notify_waiters();
    }

    /// Completes once any job has ended after the future was enabled.
    pub fn ended(&self) -> Notified<'_> {
        self.ended.notified()
    }

    /// A job runs, has come further or has more history: of interest to those who
    /// follow it, not to the many who wait for its end.
    pub fn job_changed(&self) {
        self.changed.notify_waiters();
    }

    /// Completes once any job has changed after the future was enabled.
    pub fn changed(&self) -> Notified<'_> {
        self.changed.notified()
    }

    /// A running job is no longer wanted.
    pub fn job_unwanted(&self) {
        self.cancelling.notify_waiters();
    }

    /// Completes once some running job is no longer wanted.
    pub fn unwanted(&self) -> Notified<'_> {
        self.cancelling.notified()
    }

    /// The process is asked to stop: whoever waits for something answers now.
    pub fn stop(&self) {
        self.stopping.send_replace(true);
    }

    /// Whether the process was asked to stop.
    pub fn is_stopping(&self) -> bool {
        *self.stopping.borrow()
    }

    /// Completes once the process is asked to stop.
    pub async fn stopped(&self) {
        let mut stopping = self.stopping.subscribe();
        // Cannot fail: the sender lives as long as `self`.
        let _ = stopping.wait_for(|stopping| *stopping).await;
    }
}
