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
    stopping: watch::Sender<bool>,
}

impl Default for Signals {
    fn default() -> Self {
        Self { queued: Notify::new(), ended: Notify::new(), stopping: watch::Sender::new(false) }
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

    /// A job has ended.
    pub fn job_ended(&self) {
        self.ended.notify_waiters();
    }

    /// Completes once a job has ended after the future was enabled.
    pub fn ended(&self) -> Notified<'_> {
        self.ended.notified()
    }

    /// The process is asked to stop: whoever waits for something answers now.
    pub fn stop(&self) {
        self.stopping.send_replace(true);
    }

    /// Completes once the process is asked to stop.
    pub async fn stopped(&self) {
        let mut stopping = self.stopping.subscribe();
        // Cannot fail: the sender lives as long as `self`.
        let _ = stopping.wait_for(|stopping| *stopping).await;
    }
}
