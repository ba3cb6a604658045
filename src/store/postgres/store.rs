//! The methods of a store on Postgres. Each calls the module that has its statements.

use std::time::Duration;

use async_trait::async_trait;

use crate::store::{
    AxisRow, Beat, Cancelling, ConvergencePoint, Description, Expired, FileRow, IdempotencyKey,
    Inserted, JobFilter, JobRow, Lease, MeasurementFilter, MeasurementRow, NewJobRow, Outcome,
    Page, QueueState, Reach, Recovered, RereadRow, Rereading, ResultFilter, Store, StoreError,
    StoredResult, Wake,
};

use super::{Engine, history, jobs, measurements, queue, recovery, results, retention, wakes};

#[async_trait]
impl Store for Engine {
    async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query(
            "INSERT INTO probe (id, at_ms) VALUES (1, (SELECT now_ms FROM clock))
             ON CONFLICT (id) DO UPDATE SET at_ms = excluded.at_ms",
        )
        .execute(&self.pool)
        .await?;
        Ok(())
    }

    async fn listen(&self, heard: &(dyn Fn(Wake) + Send + Sync)) -> Result<(), StoreError> {
        wakes::listen(&self.pool, heard).await
    }

    async fn insert_measurement(
        &self,
        reach: &Reach,
        row: &MeasurementRow,
        files: &[FileRow],
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let written = measurements::insert(&mut transaction, reach, row, files, key).await?;
        transaction.commit().await?;
        Ok(written)
    }

    async fn measurement(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Option<MeasurementRow>, StoreError> {
        Ok(measurements::get(&self.pool, reach, id).await?)
    }

    async fn measurement_files(&self, reach: &Reach, id: &str) -> Result<Vec<FileRow>, StoreError> {
        Ok(measurements::files(&self.pool, reach, id).await?)
    }

    async fn measurements(
        &self,
        reach: &Reach,
        filter: &MeasurementFilter,
        page: &Page,
    ) -> Result<Vec<MeasurementRow>, StoreError> {
        Ok(measurements::list(&self.pool, reach, filter, page).await?)
    }

    async fn describe_measurement(
        &self,
        reach: &Reach,
        id: &str,
        description: &Description,
    ) -> Result<bool, StoreError> {
        Ok(measurements::describe(&self.pool, reach, id, description).await?)
    }

    async fn reread_measurement(
        &self,
        reach: &Reach,
        id: &str,
        reread: &RereadRow,
    ) -> Result<Rereading, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let outcome = measurements::reread(&mut transaction, reach, id, reread).await?;
        transaction.commit().await?;
        Ok(outcome)
    }

    async fn delete_measurement(&self, reach: &Reach, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let deleted = measurements::delete(&mut transaction, reach, id).await?;
        transaction.commit().await?;
        if deleted {
            self.speaker.say(&[Wake::Unwanted, Wake::Ended]);
        }
        Ok(deleted)
    }

    async fn insert_job(
        &self,
        reach: &Reach,
        row: &NewJobRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let written = jobs::insert(&mut transaction, reach, row, key).await?;
        transaction.commit().await?;
        if written == Inserted::Created {
            self.speaker.say(&[Wake::Queued]);
        }
        Ok(written)
    }

    async fn job(&self, reach: &Reach, id: &str) -> Result<Option<JobRow>, StoreError> {
        Ok(jobs::get(&self.pool, reach, id).await?)
    }

    async fn unended(&self, ids: &[String]) -> Result<Vec<String>, StoreError> {
        let those = "SELECT id FROM jobs WHERE id = ANY($1) AND status IN ('queued', 'running')";
        let those = sqlx::query_scalar(those).bind(ids);
        Ok(those.fetch_all(&self.pool).await?)
    }

    async fn jobs(
        &self,
        reach: &Reach,
        filter: &JobFilter,
        page: &Page,
    ) -> Result<Vec<JobRow>, StoreError> {
        Ok(jobs::list(&self.pool, reach, filter, page).await?)
    }

    async fn delete_job(&self, reach: &Reach, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let deleted = jobs::delete(&mut transaction, reach, id).await?;
        transaction.commit().await?;
        if deleted {
            self.speaker.say(&[Wake::Unwanted, Wake::Ended]);
        }
        Ok(deleted)
    }

    async fn delete_older(&self, age: Duration, limit: u32) -> Result<Expired, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let deleted = retention::delete_older(&mut transaction, age, limit).await?;
        transaction.commit().await?;
        if deleted.jobs > 0 {
            self.speaker.say(&[Wake::Ended]);
        }
        Ok(deleted)
    }

    async fn result(&self, reach: &Reach, id: &str) -> Result<Option<String>, StoreError> {
        Ok(jobs::result(&self.pool, reach, id).await?)
    }

    async fn results(
        &self,
        reach: &Reach,
        filter: &ResultFilter,
        limit: u32,
    ) -> Result<Vec<StoredResult>, StoreError> {
        Ok(results::list(&self.pool, reach, filter, limit).await?)
    }

    async fn axes(
        &self,
        reach: &Reach,
        machine: Option<&str>,
        limit: u32,
    ) -> Result<Vec<AxisRow>, StoreError> {
        Ok(results::axes(&self.pool, reach, machine, limit).await?)
    }

    async fn convergence(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Vec<ConvergencePoint>, StoreError> {
        Ok(history::of_latest_attempt(&self.pool, reach, id).await?)
    }

    async fn history(
        &self,
        reach: &Reach,
        id: &str,
        from: i64,
        limit: u32,
    ) -> Result<Vec<ConvergencePoint>, StoreError> {
        Ok(history::from(&self.pool, reach, id, from, limit).await?)
    }

    async fn queue(&self) -> Result<QueueState, StoreError> {
        Ok(queue::state(&self.pool).await?)
    }

    async fn cancel(&self, reach: &Reach, id: &str) -> Result<Cancelling, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let cancelling = queue::cancel(&mut transaction, reach, id).await?;
        transaction.commit().await?;
        match cancelling {
            Cancelling::Cancelled => self.speaker.say(&[Wake::Ended]),
            Cancelling::Requested => self.speaker.say(&[Wake::Unwanted, Wake::Changed]),
            Cancelling::Unknown | Cancelling::Ended(_) => {}
        }
        Ok(cancelling)
    }

    async fn lease(&self, worker: &str, duration: Duration) -> Result<Option<Lease>, StoreError> {
        let lease = queue::lease(&self.pool, worker, duration, self.whole.is_due()).await?;
        if lease.is_some() {
            self.speaker.say(&[Wake::Changed]);
        }
        Ok(lease)
    }

    async fn heartbeat(
        &self,
        lease: &Lease,
        duration: Duration,
        progress: Option<&str>,
        rows: &[ConvergencePoint],
    ) -> Result<Beat, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let beat = queue::renew(&mut transaction, lease, duration, progress, rows).await?;
        transaction.commit().await?;
        if beat != Beat::Lost && (progress.is_some() || !rows.is_empty()) {
            self.speaker.say(&[Wake::Changed]);
        }
        Ok(beat)
    }

    async fn finish(&self, lease: &Lease, outcome: &Outcome) -> Result<bool, StoreError> {
        let finished = queue::finish(&self.pool, lease, outcome).await?;
        if finished {
            self.speaker.say(&[Wake::Ended]);
        }
        Ok(finished)
    }

    async fn hand_back(&self, lease: &Lease) -> Result<bool, StoreError> {
        let handed_back = queue::hand_back(&self.pool, lease).await?;
        if handed_back {
            // It is queued again, or ended where that was asked for.
            self.speaker.say(&[Wake::Queued, Wake::Ended]);
        }
        Ok(handed_back)
    }

    async fn recover_expired(&self, wait: Duration) -> Result<Recovered, StoreError> {
        if !self.recovery.is_due() {
            return Ok(Recovered::default());
        }
        let mut transaction = self.pool.begin().await?;
        let recovered = recovery::recover_expired(&mut transaction, wait).await?;
        transaction.commit().await?;
        let Some(recovered) = recovered else { return Ok(Recovered::default()) };
        self.recovery.make_due();
        if recovered.requeued > 0 {
            self.speaker.say(&[Wake::Queued]);
        }
        if !recovered.ended.is_empty() {
            self.speaker.say(&[Wake::Ended]);
        }
        Ok(recovered)
    }
}
