//! The engine on a Postgres database, which servers and workers on any number of machines share.
//!
//! Writes run side by side. Each waits for the rows that it changes and decides on what it then
//! finds; what no row stands for has a lock of its own in `locks`. A process that is cut off or
//! stopped in the midst of a transaction must not hold up the others: the database ends such a
//! transaction after [`IDLE`].

mod batches;
mod connections;
mod history;
mod idempotency;
mod jobs;
mod keys;
mod locks;
mod mappings;
mod measurements;
pub(super) mod migrations;
mod outbox;
mod pace;
mod portable;
mod queue;
mod recovery;
mod results;
mod retention;
#[cfg(test)]
mod upgrade;
mod wakes;

use std::time::Duration;

use async_trait::async_trait;
use sqlx::PgPool;
use sqlx::postgres::PgConnectOptions;

use super::{
    AxisRow, Beat, Cancelling, ConvergencePoint, Description, Expired, FileRow, IdempotencyKey,
    Inserted, JobFilter, JobRow, Lease, MappingRow, MeasurementFilter, MeasurementRow, NewJobRow,
    Outcome, Page, QueueState, Reach, Recovered, RereadRow, Rereading, ResultFilter, Store,
    StoreError, StoredResult, Wake,
};
use pace::{Lowest, Pace};
use wakes::Speaker;

/// Connections of one process, beside the two that tell others what it did and hear what they did.
const CONNECTIONS: u32 = 9;

/// After how long the database ends a transaction of a process that says nothing, and a wait for
/// another transaction.
const IDLE: &str = "30s";

/// Store on one Postgres database, which any number of processes share.
#[derive(Debug)]
pub struct Postgres {
    pool: PgPool,
    speaker: Speaker,
    /// Looks at the whole queue.
    whole: Pace,
    /// Looks for expired leases where there were none.
    recovery: Pace,
    /// Where events are looked for.
    events: Lowest,
}

impl Postgres {
    /// Connects to the database of an address as in `postgres://user:password@host/database` and
    /// brings its tables to the form this version needs.
    ///
    /// # Errors
    /// When the address cannot be used, or the database not be reached or migrated.
    pub async fn open(address: &str) -> Result<Self, StoreError> {
        let store = Self::connect(address).await?;
        migrations::run(&store.pool).await?;
        Ok(store)
    }

    /// Connects to a database as it is.
    ///
    /// # Errors
    /// When the address cannot be used, the database not be reached, or it is not of this version.
    pub async fn open_existing(address: &str) -> Result<Self, StoreError> {
        let store = Self::connect(address).await?;
        migrations::check(&store.pool).await?;
        Ok(store)
    }

    async fn connect(address: &str) -> Result<Self, StoreError> {
        let options: PgConnectOptions = address.parse()?;
        let options = options.application_name("servoscope").options([
            ("idle_in_transaction_session_timeout", IDLE),
            ("lock_timeout", IDLE),
            // That a table is there already is no news for a log.
            ("client_min_messages", "warning"),
        ]);
        let pool = connections::pool(CONNECTIONS).connect_with(options.clone()).await?;
        Ok(Self {
            pool,
            speaker: Speaker::new(options),
            whole: Pace::default(),
            recovery: Pace::default(),
            events: Lowest::default(),
        })
    }
}

#[async_trait]
impl Store for Postgres {
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

    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError> {
        Ok(mappings::put(&self.pool, reach, row, most).await?)
    }

    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError> {
        Ok(mappings::get(&self.pool, reach, name).await?)
    }

    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError> {
        Ok(mappings::of_layout(&self.pool, reach, layout).await?)
    }

    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError> {
        Ok(mappings::list(&self.pool, reach, limit).await?)
    }

    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError> {
        Ok(mappings::delete(&self.pool, reach, name).await?)
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
