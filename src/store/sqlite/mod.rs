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
mod store;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{SqlitePool, Transaction};

use super::StoreError;

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
