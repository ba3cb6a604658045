//! Batches: many jobs that are made, watched and cancelled together.
//!
//! A batch and all its jobs are stored in one transaction, so that a process that is killed leaves
//! either all of them or none. The jobs are one statement that reads a list, not ten thousand
//! statements: the lock of the writer is held for some tenths of a second even then. Filling a batch
//! in piece by piece would hold it for less, but everything that counts, cancels or deletes jobs would
//! have to know of jobs that are still to come.
//!
//! To cancel and to delete a batch goes piece by piece: where that is interrupted, what was left is
//! ordinary, and the same request goes on with it.

use async_trait::async_trait;

use super::{
    IdempotencyKey, Inserted, MeasurementRow, Millis, Page, Priority, Reach, Status, StoreError,
};

/// A batch to be stored with its jobs.
#[derive(Debug, Clone, PartialEq)]
pub struct NewBatchRow {
    /// UUID version 7.
    pub id: String,
    /// Its name, for people.
    pub name: Option<String>,
    /// Whoever makes it: its jobs are queued behind those that the same submitter has waiting.
    pub submitter: String,
    /// Kind of its jobs.
    pub kind: String,
    /// Which of its submitter's jobs they go before.
    pub priority: Priority,
    /// JSON of the request, every option in effect.
    pub request: String,
    /// Its jobs, in the order of their ids.
    pub jobs: Vec<NewMemberRow>,
}

/// A job of a batch to be stored.
#[derive(Debug, Clone, PartialEq)]
pub struct NewMemberRow {
    /// UUID version 7.
    pub job_id: String,
    /// The measurement it works on.
    pub measurement_id: String,
    /// JSON of the request of this job.
    pub request: String,
    /// Name of the first file of the measurement.
    pub file: Option<String>,
}

/// A batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BatchRow {
    /// UUID version 7.
    pub id: String,
    /// When it was stored.
    pub created_at_ms: Millis,
    /// Its name.
    pub name: Option<String>,
    /// Kind of its jobs.
    pub kind: String,
    /// JSON of the request.
    pub request: String,
    /// How many jobs it had at first.
    pub jobs: i64,
}

/// How many jobs of a batch stand at one point with one outcome.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TallyRow {
    /// The batch.
    pub batch_id: String,
    /// Where they stand.
    pub status: Status,
    /// The verdict of each, or [`NOT_TESTED`](super::NOT_TESTED).
    pub verdict: Option<String>,
    /// The strongest cause that each names.
    pub cause: Option<String>,
    /// How many.
    pub jobs: i64,
    /// When the latest attempt of the first of them began.
    pub started_ms: Option<Millis>,
    /// When the last of them ended.
    pub finished_ms: Option<Millis>,
}

/// Why jobs of a batch failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailureRow {
    /// In words.
    pub reason: String,
    /// How many for this reason.
    pub jobs: i64,
}

/// A job of a batch, or what is left of one that is gone.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberRow {
    /// The measurement.
    pub measurement_id: String,
    /// Name of its first file.
    pub file: Option<String>,
    /// The job.
    pub job_id: String,
    /// Where it stands; `None`: it was deleted.
    pub status: Option<Status>,
    /// Its verdict, or [`NOT_TESTED`](super::NOT_TESTED).
    pub verdict: Option<String>,
    /// The strongest cause that it names.
    pub cause: Option<String>,
    /// The confidence in that cause.
    pub confidence: Option<f64>,
    /// JSON of why it failed.
    pub failure: Option<String>,
}

/// Which jobs of a batch to list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Those that stand there.
    At(Status),
    /// Those that were deleted.
    Deleted,
}

impl Standing {
    /// Its name in statements.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::At(status) => status.name(),
            Self::Deleted => "deleted",
        }
    }
}

/// How many jobs one step of cancelling a batch came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CancelledRows {
    /// Those that waited, and are cancelled.
    pub cancelled: u64,
    /// Those that run, and whose workers have been told.
    pub requested: u64,
}

impl CancelledRows {
    /// By where the jobs were left.
    pub(super) fn of(left: &[Status]) -> Self {
        let cancelled = left.iter().filter(|status| **status == Status::Cancelled).count() as u64;
        Self { cancelled, requested: left.len() as u64 - cancelled }
    }
}

/// The part of a store that keeps batches.
#[async_trait]
pub trait Batches {
    /// Those of these measurements that there are, in any order.
    async fn measurements_of(
        &self,
        reach: &Reach,
        ids: &[String],
    ) -> Result<Vec<MeasurementRow>, StoreError>;

    /// Stores a batch and queues its jobs, unless `key` answers the request.
    async fn insert_batch(
        &self,
        reach: &Reach,
        row: &NewBatchRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError>;

    /// The batch, if there is one with this id.
    async fn batch(&self, reach: &Reach, id: &str) -> Result<Option<BatchRow>, StoreError>;

    /// Batches, newest first.
    async fn batches(&self, reach: &Reach, page: &Page) -> Result<Vec<BatchRow>, StoreError>;

    /// Where the jobs of batches stand, in any order. Deleted ones are not counted.
    async fn batch_tallies(
        &self,
        reach: &Reach,
        ids: &[String],
    ) -> Result<Vec<TallyRow>, StoreError>;

    /// Why jobs of a batch failed, the most frequent reasons first.
    async fn batch_failures(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Vec<FailureRow>, StoreError>;

    /// At most `limit` jobs of a batch in the order of the request, behind the job `after`.
    async fn batch_members(
        &self,
        reach: &Reach,
        id: &str,
        standing: Option<Standing>,
        after: Option<&str>,
        limit: u32,
    ) -> Result<Vec<MemberRow>, StoreError>;

    /// Cancels at most `limit` jobs of a batch, as [`Store::cancel`](super::Store::cancel) does.
    /// `None`: there is no such batch.
    async fn cancel_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<CancelledRows>, StoreError>;

    /// Removes at most `limit` jobs of a batch, and the batch with the last of them: it is gone where
    /// fewer were removed. `None`: there is no such batch.
    async fn delete_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<u64>, StoreError>;
}
