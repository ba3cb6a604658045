//! What a job's task writes to the store: that it is alive, how the job ended, or that it is handed
//! back.

use std::pin::pin;
use std::sync::Arc;

use tracing::{error, info, warn};

use crate::store::{Beat, ConvergencePoint, Outcome, Reach, StoreError};

use super::attempt::Attempt;
use super::{refused, within};

impl Attempt {
    /// Renews the lease and stores what the computation has reported; what could not be stored is
    /// stored by the next one.
    pub(super) async fn beat(&mut self) -> Result<Beat, StoreError> {
        let (progress, rows) = self.watch.take();
        self.unsent.extend(rows);
        self.unsent_progress = progress.or(self.unsent_progress.take());
        // Numbers and text only; should it fail all the same, the job goes on.
        let json = self.unsent_progress.as_ref().map(serde_json::to_string);
        let json = json.and_then(Result::ok);
        let told = !self.unsent.is_empty() || self.unsent_progress.is_some();
        let beat = match self.renew(json.as_deref(), &self.unsent).await {
            Err(error @ StoreError::Full(_)) if told => return self.keep(error).await,
            // Stored later it would be refused again, and the lease lost.
            Err(error) if told && error.is_permanent() => {
                warn!(%error, "the database refuses what a computation reports; it is left out");
                self.renew(None, &[]).await?
            }
            beat => beat?,
        };
        self.unsent.clear();
        self.unsent_progress = None;
        if told {
            self.shared.signals.job_changed();
        }
        Ok(beat)
    }

    /// Keeps the lease, which needs no room, while there is none for what is to be told.
    async fn keep(&self, full: StoreError) -> Result<Beat, StoreError> {
        match self.renew(None, &[]).await? {
            Beat::Lost => Ok(Beat::Lost),
            Beat::Renewed { cancel_requested } => {
                if cancel_requested {
                    self.watch.cancel();
                }
                Err(full)
            }
        }
    }

    async fn renew(
        &self,
        progress: Option<&str>,
        rows: &[ConvergencePoint],
    ) -> Result<Beat, StoreError> {
        let lease = self.shared.settings.lease;
        self.shared.answer(self.shared.store.heartbeat(&self.lease, lease, progress, rows)).await
    }

    /// Stores how the job ended, however long that takes, as long as the lease is this worker's and
    /// the process does not stop. Where the database refuses it for good, the job ends as failed.
    pub(super) async fn finish(mut self, mut outcome: Outcome) {
        let shared = Arc::clone(&self.shared);
        let mut stopped = pin!(shared.signals.stopped());
        let mut refused = false;
        loop {
            match self.store(&outcome).await {
                Ok(true) => {
                    let (status, ran) = (outcome.status(), self.watch.elapsed());
                    info!(outcome = status.name(), seconds = ran.as_secs_f64(), "job ends");
                    let metrics = shared.service.metrics();
                    metrics.job_ended(&self.lease.kind, status, Some(ran));
                    return shared.signals.job_ended();
                }
                Ok(false) => return warn!("lease lost; its result is given up"),
                Err(error) if error.is_permanent() && refused => {
                    return error!(%error, "the database refuses every outcome; the lease expires");
                }
                Err(error) if error.is_permanent() => {
                    outcome = refused::instead(&error);
                    refused = true;
                    continue;
                }
                Err(error) => warn!(%error, "the outcome cannot be stored"),
            }
            tokio::select! {
                () = &mut stopped => return self.hand_back(&"the process stops").await,
                () = tokio::time::sleep(shared.settings.lease / 10) => {}
            }
        }
    }

    /// Stores the outcome. `false`: the lease is lost, and the outcome was not stored before.
    pub(super) async fn store(&mut self, outcome: &Outcome) -> Result<bool, StoreError> {
        let held = self.beat().await? != Beat::Lost;
        if held {
            let finished = self.shared.answer(self.shared.store.finish(&self.lease, outcome)).await;
            self.tried |= finished.is_err();
            if finished? {
                return Ok(true);
            }
        }
        Ok(self.tried && self.is_stored(outcome).await?)
    }

    /// Whether the job has ended in this attempt, and so.
    async fn is_stored(&self, outcome: &Outcome) -> Result<bool, StoreError> {
        let (reach, id) = (Reach::everything(), &self.lease.job_id);
        let job = self.shared.answer(self.shared.store.job(&reach, id)).await?;
        let Some(job) = job else { return Ok(false) };
        Ok(job.attempt == self.lease.attempt && job.status == outcome.status())
    }

    pub(super) async fn hand_back(self, reason: &(dyn std::fmt::Display + Sync)) {
        // Not tried again: it may take as long as the lease can last.
        let handed_back = self.shared.store.hand_back(&self.lease);
        match within(self.shared.settings.lease, handed_back).await {
            Ok(_) => info!(%reason, "job handed back"),
            Err(error) => warn!(%error, %reason, "job not handed back; its lease expires"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use servoscope_core::answers::ConvergenceRow;
    use servoscope_core::observer::Observer as _;

    use super::*;
    use crate::service::testing::SUCCEED;
    use crate::service::{ServiceError, Upload};
    use crate::store::{FileRow, Status};
    use crate::worker::Settings;
    use crate::worker::tests::{Bench, PATIENCE};

    const LONG: Duration = Duration::from_secs(600);

    /// Everything but a result can be stored.
    const NO_ROOM: &str = "CREATE TRIGGER no_room BEFORE UPDATE OF status ON jobs
        WHEN NEW.status = 'succeeded' BEGIN SELECT RAISE(ABORT, 'no room'); END";
    const ROOM: &str = "DROP TRIGGER no_room";

    #[tokio::test]
    async fn a_result_that_cannot_be_stored_for_many_leases_is_stored_at_last() {
        let bench = Bench::new().await;
        bench.execute(NO_ROOM).await;
        let lease = Duration::from_secs(1);
        bench.work_with(Settings { lease, ..Settings::new(1) });
        let id = bench.submit(SUCCEED).await;
        bench.running(&id).await;
        tokio::time::sleep(lease * 9 / 2).await;
        let job = bench.service.job(&id).await.unwrap().row;
        assert_eq!((job.status, job.attempt), (Status::Running, 1));
        bench.execute(ROOM).await;
        let job = bench.ended(&id).await.row;
        assert_eq!((job.status, job.attempt), (Status::Succeeded, 1));
    }

    #[tokio::test]
    async fn a_worker_that_stops_hands_back_what_it_cannot_store() {
        let bench = Bench::new().await;
        bench.execute(NO_ROOM).await;
        let worker = bench.work_with(Settings::new(1));
        let id = bench.submit(SUCCEED).await;
        bench.running(&id).await;
        bench.signals.stop();
        tokio::time::timeout(PATIENCE, worker).await.expect("it stops").unwrap();
        assert_eq!(bench.service.job(&id).await.unwrap().row.status, Status::Queued);
    }

    #[tokio::test]
    async fn an_outcome_that_was_stored_though_its_answer_was_lost_is_counted_and_told() {
        let bench = Bench::new().await;
        bench.submit(SUCCEED).await;
        let mut attempt = bench.attempt(LONG).await;
        let outcome = Outcome::Succeeded("{}".into());
        bench.execute(NO_ROOM).await;
        assert!(attempt.store(&outcome).await.is_err());
        bench.execute(ROOM).await;
        // What the worker was told is as if the answer to this had been lost.
        assert!(bench.store.finish(&attempt.lease, &outcome).await.unwrap());

        let mut told = pin!(bench.signals.ended());
        told.as_mut().enable();
        attempt.finish(outcome).await;
        tokio::time::timeout(PATIENCE, told).await.expect("its end is told");
        let counted = "servoscope_jobs_ended_total{kind=\"identify\",outcome=\"succeeded\"} 1";
        let text = bench.service.metrics_text().await.unwrap();
        assert!(text.lines().any(|line| line == counted), "{text}");
    }

    #[tokio::test]
    async fn a_result_is_given_up_where_somebody_else_has_ended_the_job() {
        let bench = Bench::new().await;
        bench.submit(SUCCEED).await;
        let mut attempt = bench.attempt(LONG).await;
        let outcome = Outcome::Succeeded("{}".into());
        bench.execute(NO_ROOM).await;
        assert!(attempt.store(&outcome).await.is_err());
        assert!(bench.store.finish(&attempt.lease, &Outcome::Cancelled).await.unwrap());
        assert!(!attempt.store(&outcome).await.unwrap());
    }

    /// Stores measurements of so many bytes until there is no room.
    async fn fill(bench: &Bench, bytes: usize) {
        loop {
            let (name, content_type) = ("a.csv".to_owned(), "text/csv".to_owned());
            let files = vec![FileRow { name, content_type, bytes: vec![b'x'; bytes] }];
            let upload = Upload { files, ..Upload::default() };
            match bench.service.add_measurement(upload, None).await {
                Ok(_) => {}
                Err(ServiceError::Store(StoreError::Full(_))) => return,
                Err(error) => panic!("{error}"),
            }
        }
    }

    #[tokio::test]
    async fn a_lease_is_kept_while_there_is_no_room_for_what_is_to_be_told() {
        let bench = Bench::limited(Some(2 << 20)).await;
        bench.submit(SUCCEED).await;
        let mut attempt = bench.attempt(LONG).await;
        fill(&bench, 1 << 16).await;
        fill(&bench, 1).await;
        for cycle in 0..20 {
            let (stage, elapsed_s) = ("colony".repeat(600), 0.5);
            let row =
                ConvergenceRow { stage, cycle, evaluations: 2, best: 0.5, mean: None, elapsed_s };
            attempt.watch.row(row);
        }
        let short = Duration::from_secs(2);
        let renewed = bench.store.heartbeat(&attempt.lease, short, None, &[]).await.unwrap();
        assert_eq!(renewed, Beat::Renewed { cancel_requested: false });
        let full = attempt.beat().await;
        assert!(matches!(full, Err(StoreError::Full(_))), "{full:?}");
        assert_eq!(attempt.unsent.len(), 20, "what was not stored is stored later");
        tokio::time::sleep(short).await;
        let kept = bench.store.heartbeat(&attempt.lease, LONG, None, &[]).await.unwrap();
        assert_eq!(kept, Beat::Renewed { cancel_requested: false });
    }
}
