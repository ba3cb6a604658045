//! Waiting for the ends of jobs: one look at the store for all that wait in this process.
//!
//! When a job has ended, here or elsewhere, and every second, those that are waited for are looked up
//! together, ten times a second at most. So the store is asked as often however many wait, and nobody
//! reads a job again before it has ended.

use std::collections::{HashMap, HashSet};
use std::pin::pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tracing::warn;

use crate::store::{Store, StoreError};

use super::Signals;

/// How often the store is looked at without a signal: jobs may end in another process.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// How long ends are gathered until the store is looked at once for all of them.
const GATHER: Duration = Duration::from_millis(100);

/// How long the store may take to answer until it is asked again.
const PATIENCE: Duration = Duration::from_secs(10);

/// The jobs whose ends are waited for.
#[derive(Debug, Default)]
pub(super) struct Ends(Mutex<Waiting>);

#[derive(Debug, Default)]
struct Waiting {
    /// Everybody who is to be told, by job.
    jobs: HashMap<String, Vec<oneshot::Sender<()>>>,
    /// The task that looks, while somebody waits.
    looks: Option<JoinHandle<()>>,
}

impl Ends {
    /// Completes soon after the job has ended or is gone. Whether it had ended before the caller finds out
    /// by itself, after this call.
    pub(super) fn of(
        self: &Arc<Self>,
        id: &str,
        store: &Arc<dyn Store>,
        signals: &Arc<Signals>,
    ) -> oneshot::Receiver<()> {
        let (sender, told) = oneshot::channel();
        let mut waiting = self.waiting();
        waiting.jobs.entry(id.to_owned()).or_default().push(sender);
        if waiting.looks.as_ref().is_none_or(JoinHandle::is_finished) {
            let looks = look(Arc::clone(self), Arc::clone(store), Arc::clone(signals));
            waiting.looks = Some(tokio::spawn(looks));
        }
        told
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        // A panic cannot leave it half-written in a way that matters: somebody is told later.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The jobs that somebody still waits for. `None`: the task that looks is no longer needed.
    fn asked(&self) -> Option<Vec<String>> {
        let mut waiting = self.waiting();
        waiting.jobs.retain(|_, told| {
            told.retain(|told| !told.is_closed());
            !told.is_empty()
        });
        if waiting.jobs.is_empty() {
            waiting.looks = None;
            return None;
        }
        Some(waiting.jobs.keys().cloned().collect())
    }

    /// Tells those who wait for one of these jobs that is not among the open ones.
    fn tell(&self, asked: &[String], open: &[String]) {
        let open: HashSet<&String> = open.iter().collect();
        let mut waiting = self.waiting();
        for id in asked.iter().filter(|id| !open.contains(id)) {
            for told in waiting.jobs.remove(id).unwrap_or_default() {
                // It fails where nobody waits any more.
                let _ = told.send(());
            }
        }
    }
}

/// Looks for ends until nobody waits.
async fn look(ends: Arc<Ends>, store: Arc<dyn Store>, signals: Arc<Signals>) {
    loop {
        let mut ended = pin!(signals.ended());
        // Before looking: a job that ends in between is not missed.
        ended.as_mut().enable();
        let Some(asked) = ends.asked() else { return };
        let open = tokio::time::timeout(PATIENCE, store.unended(&asked)).await;
        match open.unwrap_or(Err(StoreError::Silent)) {
            Ok(open) => ends.tell(&asked, &open),
            Err(error) => warn!(%error, "the jobs that are waited for cannot be looked up"),
        }
        tokio::time::sleep(GATHER).await;
        tokio::select! {
            () = ended => {}
            () = tokio::time::sleep(LOOK_AGAIN) => {}
            // Whoever waits answers now.
            () = signals.stopped() => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::service::testing::Scripted;
    use crate::service::{Service, Submission, Upload};
    use crate::store::{FileRow, Sqlite, Status};

    /// Far more than anything here takes.
    const LONG: Duration = Duration::from_secs(60);

    async fn submitted(service: &Service) -> String {
        let (name, content_type) = ("a.csv".to_owned(), "text/csv".to_owned());
        let files = vec![FileRow { name, content_type, bytes: b"any".to_vec() }];
        let upload = Upload { files, ..Upload::default() };
        let measurement_id = service.add_measurement(upload, None).await.unwrap().resource.row.id;
        let submission =
            Submission { measurement_id, kind: "identify".into(), ..Submission::default() };
        service.submit(&submission, None).await.unwrap().resource.row.id
    }

    #[tokio::test]
    async fn an_end_in_another_process_is_told_to_all_who_wait_and_to_nobody_else() {
        let folder = tempfile::tempdir().unwrap();
        let store: Arc<dyn Store> = Arc::new(Sqlite::open(folder.path()).await.unwrap());
        // The store is all that two processes share.
        let process = || Service::new(Arc::clone(&store), Arc::new(Scripted), Arc::default());
        let (service, other) = (process(), process());
        let (ends, stays) = (submitted(&service).await, submitted(&service).await);
        let waits = || service.job_when_ended(&ends, LONG);
        let patience = 2 * LOOK_AGAIN;
        let still = async {
            let began = Instant::now();
            (service.job_when_ended(&stays, patience).await, began.elapsed())
        };
        let cancels = async { other.cancel(&ends).await.unwrap() };
        let (first, second, (still, waited), _) = tokio::join!(waits(), waits(), still, cancels);
        for told in [first, second] {
            assert_eq!(told.unwrap().row.status, Status::Cancelled);
        }
        assert_eq!(still.unwrap().row.status, Status::Queued);
        assert!(waited >= patience, "it was told after {waited:?}");
    }

    #[tokio::test]
    async fn nobody_looks_once_nobody_waits() {
        let folder = tempfile::tempdir().unwrap();
        let store: Arc<dyn Store> = Arc::new(Sqlite::open(folder.path()).await.unwrap());
        let signals = Arc::new(Signals::default());
        let service = Service::new(Arc::clone(&store), Arc::new(Scripted), Arc::clone(&signals));
        let id = submitted(&service).await;
        let ends = Arc::new(Ends::default());
        let waits = ends.of(&id, &store, &signals);
        assert_eq!(ends.asked(), Some(vec![id.clone()]));
        drop(waits);
        while ends.waiting().looks.is_some() {
            tokio::time::sleep(GATHER).await;
        }
        assert!(ends.waiting().jobs.is_empty());
        let again = ends.of(&id, &store, &signals);
        service.delete_job(&id).await.unwrap();
        tokio::time::timeout(LONG, again).await.expect("it is told").unwrap();
    }
}
