//! The engine on one SQLite file.
//!
//! Statements name their columns: one that reads all of a table is prepared for so many, and fails when
//! a newer version of the program adds one meanwhile.

mod batches;
mod boot;
mod damage;
mod history;
mod idempotency;
mod jobs;
mod keys;
mod mappings;
mod measurements;
pub(super) mod migrations;
mod outbox;
mod portable;
mod queue;
mod recovery;
mod results;
mod retention;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use async_trait::async_trait;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{SqlitePool, Transaction};

use super::{
    AxisRow, Beat, Cancelling, ConvergencePoint, Description, Expired, FileRow, IdempotencyKey,
    Inserted, JobFilter, JobRow, Lease, MappingRow, MeasurementFilter, MeasurementRow, NewJobRow,
    Outcome, Page, QueueState, Reach, Recovered, RereadRow, Rereading, ResultFilter, Store,
    StoreError, StoredResult, Wake,
};

/// How long a writer waits for another one before it gives up.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// How often a new file that another process has locked is tried again.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Name of the database in the data directory.
pub(super) const FILE_NAME: &str = "servoscope.sqlite3";

/// Connections that read at the same time.
const READERS: u32 = 4;

/// Rows that are read before they are asked for.
const ROWS_AHEAD: usize = 4;

/// Bytes of a page of the database; SQLite's own default.
const PAGE_BYTES: u64 = 4096;

/// Store on one SQLite file, which several processes of one machine may share.
///
/// SQLite has one writer at a time. Writes of a process queue for one connection
/// here, in order, rather than for the file's lock, where they would sleep and
/// try again; readers have connections of their own and never wait for a writer.
#[derive(Debug, Clone)]
pub struct Sqlite {
    readers: SqlitePool,
    writer: SqlitePool,
    /// A write has failed, and the next one gets a fresh connection. One that was
    /// opened while the file could not be written stays read-only for good, and
    /// one that met a full disk has no transaction left to roll back.
    stale: Arc<AtomicBool>,
}

impl Sqlite {
    /// Whether a data directory has a database.
    pub fn is_in(data_dir: &Path) -> bool {
        data_dir.join(FILE_NAME).is_file()
    }

    /// Opens the database in a data directory, creates what is missing and
    /// brings its tables to the form this version needs.
    ///
    /// # Errors
    /// When the directory cannot be made, or the database not be opened or
    /// migrated.
    pub async fn open(data_dir: &Path) -> Result<Self, StoreError> {
        Self::open_limited(data_dir, None).await
    }

    /// The same, for a database that may not grow beyond so many bytes: what has
    /// no room is refused as on a full disk.
    ///
    /// # Errors
    /// As for [`Sqlite::open`].
    pub async fn open_limited(data_dir: &Path, bytes: Option<u64>) -> Result<Self, StoreError> {
        std::fs::create_dir_all(data_dir)?;
        damage::check(&data_dir.join(FILE_NAME))?;
        let mut options = options(data_dir).create_if_missing(true);
        if let Some(bytes) = bytes {
            options = options.pragma("max_page_count", (bytes / PAGE_BYTES).max(1).to_string());
        }
        let began = Instant::now();
        // A new file is locked while its journal is chosen, and SQLite does not wait for that.
        let store = loop {
            match Self::connect(options.clone()).await {
                Err(error) if error.is_locked() && began.elapsed() < BUSY_TIMEOUT => {
                    tokio::time::sleep(LOOK_AGAIN).await;
                }
                connected => break connected?,
            }
        };
        migrations::run(&store.writer).await?;
        Ok(store)
    }

    /// Opens the database in a data directory as it is.
    ///
    /// # Errors
    /// When it is not there or cannot be opened, or is not of this version.
    pub async fn open_existing(data_dir: &Path) -> Result<Self, StoreError> {
        damage::check(&data_dir.join(FILE_NAME))?;
        let store = Self::connect(options(data_dir)).await?;
        migrations::check(&store.readers).await?;
        Ok(store)
    }

    async fn connect(options: SqliteConnectOptions) -> Result<Self, StoreError> {
        // A connection to a file does not break between two uses; asking it first
        // whether it answers would be a second round trip for every job looked up.
        let pool = |size| SqlitePoolOptions::new().max_connections(size).test_before_acquire(false);
        let writer = pool(1).connect_with(options.clone()).await?;
        let readers = pool(READERS).connect_with(options).await?;
        Ok(Self { readers, writer, stale: Arc::default() })
    }

    /// A transaction that takes the write lock at once: one that began by
    /// reading could not wait for another process and would fail instead.
    async fn begin(&self) -> Result<Transaction<'static, sqlx::Sqlite>, StoreError> {
        if self.stale.swap(false, Ordering::Relaxed) {
            // It is given up either way; an error of its end changes nothing.
            let _ = self.writer.acquire().await?.close().await;
        }
        let begun = self.writer.begin_with("BEGIN IMMEDIATE").await;
        if begun.is_err() {
            self.stale.store(true, Ordering::Relaxed);
        }
        Ok(begun?)
    }

    /// Ends a transaction: what was written is kept if all of it was.
    async fn end<T>(
        &self,
        transaction: Transaction<'static, sqlx::Sqlite>,
        written: sqlx::Result<T>,
    ) -> Result<T, StoreError> {
        let ended = match written {
            Ok(value) => transaction.commit().await.map(|()| value),
            // The first error says why; dropping the transaction rolls it back.
            Err(error) => Err(error),
        };
        if ended.is_err() {
            self.stale.store(true, Ordering::Relaxed);
        }
        Ok(ended?)
    }
}

/// How the database in a data directory is opened.
fn options(data_dir: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(data_dir.join(FILE_NAME))
        .foreign_keys(true)
        .busy_timeout(BUSY_TIMEOUT)
        // Readers go on while one writes; a power cut may cost the last
        // transactions but never the file.
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Normal)
        // Rows that are read ahead; one may be as large as an upload.
        .row_buffer_size(ROWS_AHEAD)
        // What is deleted is overwritten, not only forgotten.
        .pragma("secure_delete", "ON")
}

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

    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError> {
        let mut transaction = self.begin().await?;
        let created = mappings::put(&mut transaction, reach, row, most).await;
        self.end(transaction, created).await
    }

    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError> {
        Ok(mappings::get(&self.readers, reach, name).await?)
    }

    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError> {
        Ok(mappings::of_layout(&self.readers, reach, layout).await?)
    }

    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError> {
        Ok(mappings::list(&self.readers, reach, limit).await?)
    }

    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = mappings::delete(&mut transaction, reach, name).await;
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
