//! The methods of a store on SQLite. Each calls the module that has its statements.

use std::time::Duration;

use async_trait::async_trait;

use crate::store::{
    AxisRow, Beat, Cancelling, ConvergencePoint, Description, Expired, FileRow, IdempotencyKey,
    Inserted, JobFilter, JobRow, Lease, MeasurementFilter, MeasurementRow, NewJobRow, Outcome,
    Page, QueueState, Reach, Recovered, RereadRow, Rereading, ResultFilter, Store, StoreError,
    StoredResult, Wake,
};

use super::{Sqlite, history, jobs, measurements, queue, recovery, results, retention};

#[async_trait]
impl Store for Sqlite {
    async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT 1").execute(&self.readers).await?;
        let mut transaction = self.begin().await?;
        let written = sqlx::query(
            "INSERT INTO probe (id, at_ms) VALUES (1, (SELECT now_ms FROM clock))
             ON CONFLICT (id) DO UPDATE SET at_ms = excluded.at_ms",
        )
        .execute(&mut *transaction)
        .await;
        self.end(transaction, written).await?;
        Ok(())
    }

    async fn listen(&self, _heard: &(dyn Fn(Wake) + Send + Sync)) -> Result<(), StoreError> {
        Ok(())
    }

    async fn insert_measurement(
        &self,
        reach: &Reach,
        row: &MeasurementRow,
        files: &[FileRow],
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.begin().await?;
        let written = measurements::insert(&mut transaction, reach, row, files, key).await;
        self.end(transaction, written).await
    }

    async fn measurement(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Option<MeasurementRow>, StoreError> {
        Ok(measurements::get(&self.readers, reach, id).await?)
    }

    async fn measurement_files(&self, reach: &Reach, id: &str) -> Result<Vec<FileRow>, StoreError> {
        Ok(measurements::files(&self.readers, reach, id).await?)
    }

    async fn measurements(
        &self,
        reach: &Reach,
        filter: &MeasurementFilter,
        page: &Page,
    ) -> Result<Vec<MeasurementRow>, StoreError> {
        Ok(measurements::list(&self.readers, reach, filter, page).await?)
    }

    async fn describe_measurement(
        &self,
        reach: &Reach,
        id: &str,
        description: &Description,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let described = measurements::describe(&mut transaction, reach, id, description).await;
        self.end(transaction, described).await
    }

    async fn reread_measurement(
        &self,
        reach: &Reach,
        id: &str,
        reread: &RereadRow,
    ) -> Result<Rereading, StoreError> {
        let mut transaction = self.begin().await?;
        let outcome = measurements::reread(&mut transaction, reach, id, reread).await;
        self.end(transaction, outcome).await
    }

    async fn delete_measurement(&self, reach: &Reach, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = measurements::delete(&mut transaction, reach, id).await;
        self.end(transaction, deleted).await
    }

    async fn insert_job(
        &self,
        reach: &Reach,
        row: &NewJobRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.begin().await?;
        let written = jobs::insert(&mut transaction, reach, row, key).await;
        self.end(transaction, written).await
    }

    async fn job(&self, reach: &Reach, id: &str) -> Result<Option<JobRow>, StoreError> {
        Ok(jobs::get(&self.readers, reach, id).await?)
    }

    async fn unended(&self, ids: &[String]) -> Result<Vec<String>, StoreError> {
        let those = "SELECT id FROM jobs
             WHERE id IN (SELECT value FROM json_each(?1)) AND status IN ('queued', 'running')";
        let those = sqlx::query_scalar(those).bind(serde_json::json!(ids).to_string());
        Ok(those.fetch_all(&self.readers).await?)
    }

    async fn jobs(
        &self,
        reach: &Reach,
        filter: &JobFilter,
        page: &Page,
    ) -> Result<Vec<JobRow>, StoreError> {
        Ok(jobs::list(&self.readers, reach, filter, page).await?)
    }

    async fn delete_job(&self, reach: &Reach, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = jobs::delete(&mut transaction, reach, id).await;
        self.end(transaction, deleted).await
    }

    async fn delete_older(&self, age: Duration, limit: u32) -> Result<Expired, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = retention::delete_older(&mut transaction, age, limit).await;
        self.end(transaction, deleted).await
    }

    async fn result(&self, reach: &Reach, id: &str) -> Result<Option<String>, StoreError> {
        Ok(jobs::result(&self.readers, reach, id).await?)
    }

    async fn results(
        &self,
        reach: &Reach,
        filter: &ResultFilter,
        limit: u32,
    ) -> Result<Vec<StoredResult>, StoreError> {
        Ok(results::list(&self.readers, reach, filter, limit).await?)
    }

    async fn axes(
        &self,
        reach: &Reach,
        machine: Option<&str>,
        limit: u32,
    ) -> Result<Vec<AxisRow>, StoreError> {
        Ok(results::axes(&self.readers, reach, machine, limit).await?)
    }

    async fn convergence(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Vec<ConvergencePoint>, StoreError> {
        Ok(history::of_latest_attempt(&self.readers, reach, id).await?)
    }

    async fn history(
        &self,
        reach: &Reach,
        id: &str,
        from: i64,
        limit: u32,
    ) -> Result<Vec<ConvergencePoint>, StoreError> {
        Ok(history::from(&self.readers, reach, id, from, limit).await?)
    }

    async fn queue(&self) -> Result<QueueState, StoreError> {
        Ok(queue::state(&self.readers).await?)
    }

    async fn cancel(&self, reach: &Reach, id: &str) -> Result<Cancelling, StoreError> {
        let mut transaction = self.begin().await?;
        let cancelling = queue::cancel(&mut transaction, reach, id).await;
        self.end(transaction, cancelling).await
    }

    async fn lease(&self, worker: &str, duration: Duration) -> Result<Option<Lease>, StoreError> {
        let mut transaction = self.begin().await?;
        let lease = queue::lease(&mut transaction, worker, duration).await;
        self.end(transaction, lease).await
    }

    async fn heartbeat(
        &self,
        lease: &Lease,
        duration: Duration,
        progress: Option<&str>,
        rows: &[ConvergencePoint],
    ) -> Result<Beat, StoreError> {
        let mut transaction = self.begin().await?;
        let beat = queue::renew(&mut transaction, lease, duration, progress, rows).await;
        self.end(transaction, beat).await
    }

    async fn finish(&self, lease: &Lease, outcome: &Outcome) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let finished = queue::finish(&mut transaction, lease, outcome).await;
        self.end(transaction, finished).await
    }

    async fn hand_back(&self, lease: &Lease) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let handed_back = queue::hand_back(&mut transaction, lease).await;
        self.end(transaction, handed_back).await
    }

    async fn recover_expired(&self, wait: Duration) -> Result<Recovered, StoreError> {
        let mut transaction = self.begin().await?;
        let recovered = recovery::recover_expired(&mut transaction, wait).await;
        self.end(transaction, recovered).await
    }
}
