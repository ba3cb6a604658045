//! The engine on one SQLite file.

mod idempotency;
mod jobs;
mod measurements;
mod queue;

use std::path::Path;
use std::time::Duration;

use async_trait::async_trait;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{SqlitePool, Transaction};

use super::{
    Beat, Cancelling, ConvergencePoint, FileRow, IdempotencyKey, Inserted, JobFilter, JobRow,
    Lease, MeasurementFilter, MeasurementRow, NewJobRow, Outcome, Page, Recovered, Store,
    StoreError,
};

/// How long a writer waits for another one before it gives up.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// Name of the database in the data directory.
const FILE_NAME: &str = "servoscope.sqlite3";

/// Store on one SQLite file, which several processes of one machine may share.
#[derive(Debug, Clone)]
pub struct Sqlite {
    pool: SqlitePool,
}

impl Sqlite {
    /// Opens the database in a data directory, creates what is missing and
    /// brings its tables to the form this version needs.
    ///
    /// # Errors
    /// When the directory cannot be made, or the database not be opened or
    /// migrated.
    pub async fn open(data_dir: &Path) -> Result<Self, StoreError> {
        std::fs::create_dir_all(data_dir)?;
        let options = SqliteConnectOptions::new()
            .filename(data_dir.join(FILE_NAME))
            .create_if_missing(true)
            .foreign_keys(true)
            .busy_timeout(BUSY_TIMEOUT)
            // Readers go on while one writes; a power cut may cost the last
            // transactions but never the file.
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Normal);
        let pool = SqlitePoolOptions::new().max_connections(8).connect_with(options).await?;
        sqlx::migrate!("./migrations").run(&pool).await?;
        Ok(Self { pool })
    }

    /// A transaction that takes the write lock at once: one that began by
    /// reading could not wait for another writer and would fail instead.
    async fn begin(&self) -> Result<Transaction<'static, sqlx::Sqlite>, StoreError> {
        Ok(self.pool.begin_with("BEGIN IMMEDIATE").await?)
    }
}

#[async_trait]
impl Store for Sqlite {
    async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT 1").execute(&self.pool).await?;
        Ok(())
    }

    async fn insert_measurement(
        &self,
        row: &MeasurementRow,
        files: &[FileRow],
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.begin().await?;
        let claim = idempotency::claim(&mut transaction, "measurement", key, &row.id).await?;
        if claim == Inserted::Created {
            measurements::insert(&mut transaction, row, files).await?;
        }
        transaction.commit().await?;
        Ok(claim)
    }

    async fn measurement(&self, id: &str) -> Result<Option<MeasurementRow>, StoreError> {
        Ok(measurements::get(&self.pool, id).await?)
    }

    async fn measurement_files(&self, id: &str) -> Result<Vec<FileRow>, StoreError> {
        Ok(measurements::files(&self.pool, id).await?)
    }

    async fn measurements(
        &self,
        filter: &MeasurementFilter,
        page: &Page,
    ) -> Result<Vec<MeasurementRow>, StoreError> {
        Ok(measurements::list(&self.pool, filter, page).await?)
    }

    async fn insert_job(
        &self,
        row: &NewJobRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.begin().await?;
        let claim = idempotency::claim(&mut transaction, "job", key, &row.id).await?;
        if claim == Inserted::Created {
            jobs::insert(&mut transaction, row).await?;
        }
        transaction.commit().await?;
        Ok(claim)
    }

    async fn job(&self, id: &str) -> Result<Option<JobRow>, StoreError> {
        Ok(jobs::get(&self.pool, id).await?)
    }

    async fn jobs(&self, filter: &JobFilter, page: &Page) -> Result<Vec<JobRow>, StoreError> {
        Ok(jobs::list(&self.pool, filter, page).await?)
    }

    async fn result(&self, id: &str) -> Result<Option<String>, StoreError> {
        Ok(jobs::result(&self.pool, id).await?)
    }

    async fn convergence(&self, id: &str) -> Result<Vec<ConvergencePoint>, StoreError> {
        Ok(jobs::convergence(&self.pool, id).await?)
    }

    async fn cancel(&self, id: &str) -> Result<Cancelling, StoreError> {
        let mut transaction = self.begin().await?;
        let cancelling = queue::cancel(&mut transaction, id).await?;
        transaction.commit().await?;
        Ok(cancelling)
    }

    async fn lease(&self, duration: Duration) -> Result<Option<Lease>, StoreError> {
        Ok(queue::lease(&self.pool, duration).await?)
    }

    async fn heartbeat(
        &self,
        lease: &Lease,
        duration: Duration,
        progress: Option<&str>,
        rows: &[ConvergencePoint],
    ) -> Result<Beat, StoreError> {
        let mut transaction = self.begin().await?;
        let beat = queue::renew(&mut transaction, lease, duration, progress).await?;
        if beat != Beat::Lost {
            jobs::append_convergence(&mut transaction, lease, rows).await?;
        }
        transaction.commit().await?;
        Ok(beat)
    }

    async fn finish(&self, lease: &Lease, outcome: &Outcome) -> Result<bool, StoreError> {
        Ok(queue::finish(&self.pool, lease, outcome).await?)
    }

    async fn hand_back(&self, lease: &Lease) -> Result<bool, StoreError> {
        Ok(queue::hand_back(&self.pool, lease).await?)
    }

    async fn recover_expired(&self) -> Result<Recovered, StoreError> {
        let mut transaction = self.begin().await?;
        let recovered = queue::recover_expired(&mut transaction).await?;
        transaction.commit().await?;
        Ok(recovered)
    }
}
