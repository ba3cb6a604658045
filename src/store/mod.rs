//! Measurements, jobs, results, convergence history, the queue, and what is to be told.
//!
//! [`Store`] is the whole interface; an engine implements it in a folder of its
//! own, with its SQL in sight, and must pass the tests of `contract`.
//!
//! The queue works by leases. Taking a job gives a [`Lease`] that expires unless
//! it is renewed; every later write names job and attempt and has no effect once
//! the lease has expired or the job was leased again. So a worker that was
//! stopped, killed or cut off can never spoil what its successor writes. Leases
//! are timed by the database's clock.
//!
//! A worker that stops without a word takes all its jobs with it, and mostly none of them is the
//! reason. So a job whose lease expires is charged only by evidence:
//!
//! * It is *charged* where it was the only job in hand of its worker, or where the worker goes on
//!   with the others.
//! * It *shares* a death where all jobs in hand of its worker expire together, or, in a folder, where
//!   the machine has restarted since, or Postgres where the jobs are in one. That costs nothing;
//!   but after [`ALONE_AFTER`] such deaths it runs alone at first, so that the next one would be its
//!   own: for [`ALONE_FOR`], and four times as long after each further one. So a server that was
//!   killed from outside soon has all its places filled again.
//! * After its first charged or shared death it runs again at once; after the second it waits, and
//!   four times as long after each further one, so that a machine that fails for some minutes ends no
//!   job.
//! * It ends as failed after [`MAX_ATTEMPTS`] charges.
//!
//! So a job that kills its workers soon after it began ends after at most [`ALONE_AFTER`] deaths in
//! company and [`MAX_ATTEMPTS`] alone, one that does so later after some more in company, and none of
//! its siblings ends with it.
//!
//! Jobs are leased by turns. A job's turn is the next one, or one more than the largest of those that
//! the same submitter has waiting, whichever is larger; so are those of a batch, one after the other.
//! The next turn is the smallest of all that wait, or on Postgres one more than that of the job that
//! was leased last. So submitters alternate however many jobs each of them queues, and those of one
//! are leased in the order in which they came.
//!
//! A turn is the submitter's: where it has a job of a higher [`Priority`] waiting, that one is leased
//! in the turn, and the two jobs exchange theirs. The one that gave its turn away has come before its
//! equals, and goes before them from then on; of several such the oldest. So priorities order the
//! jobs of one submitter, and take no turn from another.

mod backup;
mod batches;
#[cfg(test)]
mod contract;
mod decode;
mod error;
mod gist;
mod keys;
mod outbox;
mod postgres;
mod reach;
mod rows;
mod sqlite;
mod usage;
mod versions;

use std::time::Duration;

use async_trait::async_trait;

pub use backup::{BackupError, Portable, Reader, Rows, Writer};
pub use batches::{
    BatchRow, Batches, CancelledRows, FailureRow, MemberRow, NewBatchRow, NewMemberRow, Standing,
    TallyRow,
};
pub use error::StoreError;
pub use gist::NOT_TESTED;
pub use keys::{KeyRow, Keyring};
pub use outbox::{DeliveryRow, DueRow, EventRow, NewDeliveryRow, Outbox, Settled, WebhookRow};
pub use postgres::Postgres;
pub use reach::Reach;
pub use rows::{
    AxisRow, ConvergencePoint, Description, EndedRow, Expired, FileRow, IdempotencyKey, Inserted,
    JobFilter, JobRow, Lease, MappingRow, MeasurementFilter, MeasurementRow, Millis, NewJobRow,
    Outcome, Page, Priority, QueueState, RereadRow, Rereading, ResultFilter, Status, StoredResult,
};
pub use sqlite::Sqlite;
pub use usage::Usage;

/// How often a job is charged with the death of its worker before it ends as failed.
pub const MAX_ATTEMPTS: u32 = 3;

/// Deaths of workers that a job shares with others before it runs alone.
pub const ALONE_AFTER: u32 = 3;

/// How long it runs before others begin beside it; four times as long after each further such death.
pub const ALONE_FOR: Duration = Duration::from_secs(15);

/// The longest that a job waits after a death of its worker, unless the first wait is longer.
pub const LONGEST_WAIT: Duration = Duration::from_secs(600);

/// What a heartbeat found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beat {
    /// The lease is renewed.
    Renewed {
        /// Whether somebody asked to cancel the job.
        cancel_requested: bool,
    },
    /// The lease is no longer valid; nothing was written.
    Lost,
}

/// What a request to cancel came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cancelling {
    /// There is no such job.
    Unknown,
    /// It was queued and is now cancelled.
    Cancelled,
    /// It is running; its worker has been told.
    Requested,
    /// It had ended before.
    Ended(Status),
}

/// What expired leases led to.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Recovered {
    /// Jobs that are queued again.
    pub requeued: u64,
    /// Jobs that ended: cancelled, or failed after [`MAX_ATTEMPTS`].
    pub ended: Vec<EndedRow>,
}

impl Recovered {
    /// Counts one more job, by where it was left.
    fn count(&mut self, left: EndedRow) {
        match left.status {
            Status::Queued => self.requeued += 1,
            _ => self.ended.push(left),
        }
    }
}

/// What a process says to the others that share a store. It only shortens waits: whoever waits also
/// looks now and then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wake {
    /// A job waits for a worker.
    Queued,
    /// A job runs, or has come further.
    Changed,
    /// A running job is no longer wanted.
    Unwanted,
    /// A job has ended, or is gone.
    Ended,
}

impl Wake {
    /// Every one.
    pub const ALL: [Self; 4] = [Self::Queued, Self::Changed, Self::Unwanted, Self::Ended];
}

/// Everything that is kept. Every method is one transaction.
///
/// What a caller asks for takes the [`Reach`] of the caller. The methods without one are for the
/// server's own work: the queue, and what is old.
#[async_trait]
pub trait Store: Outbox + Keyring + Batches + Portable + Send + Sync + 'static {
    /// Whether the database can be read and written.
    async fn ping(&self) -> Result<(), StoreError>;

    /// Calls `heard` for what any process does to jobs, this one included, until the database fails;
    /// returns at once where the engine passes nothing on.
    async fn listen(&self, heard: &(dyn Fn(Wake) + Send + Sync)) -> Result<(), StoreError>;

    /// Stores a measurement with its files, unless `key` answers the request.
    async fn insert_measurement(
        &self,
        reach: &Reach,
        row: &MeasurementRow,
        files: &[FileRow],
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError>;

    /// The measurement, if there is one with this id.
    async fn measurement(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Option<MeasurementRow>, StoreError>;

    /// The files of a measurement in the order of the upload.
    async fn measurement_files(&self, reach: &Reach, id: &str) -> Result<Vec<FileRow>, StoreError>;

    /// Measurements, newest first.
    async fn measurements(
        &self,
        reach: &Reach,
        filter: &MeasurementFilter,
        page: &Page,
    ) -> Result<Vec<MeasurementRow>, StoreError>;

    /// Changes what a measurement says of itself. `false`: there is none with this id.
    async fn describe_measurement(
        &self,
        reach: &Reach,
        id: &str,
        description: &Description,
    ) -> Result<bool, StoreError>;

    /// Stores another reading of a measurement's files, unless a job was queued on it.
    async fn reread_measurement(
        &self,
        reach: &Reach,
        id: &str,
        reread: &RereadRow,
    ) -> Result<Rereading, StoreError>;

    /// Removes a measurement, its files and every job on it, whatever their
    /// status: the worker of a running one loses its lease. `false`: there is none.
    async fn delete_measurement(&self, reach: &Reach, id: &str) -> Result<bool, StoreError>;

    /// Stores a mapping under its name; `false`: in place of another. `None`: it would be a new one,
    /// and its owner has `most` of them already.
    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError>;

    /// The mapping, if there is one of this name.
    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError>;

    /// The mapping for files of this layout that was stored last, if there is one.
    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError>;

    /// At most `limit` mappings, by name.
    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError>;

    /// Removes a mapping. `false`: there is none of this name.
    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError>;

    /// Queues a job, unless `key` answers the request.
    async fn insert_job(
        &self,
        reach: &Reach,
        row: &NewJobRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError>;

    /// The job, if there is one with this id.
    async fn job(&self, reach: &Reach, id: &str) -> Result<Option<JobRow>, StoreError>;

    /// Those of these jobs that wait or run: the others have ended, or are gone.
    async fn unended(&self, ids: &[String]) -> Result<Vec<String>, StoreError>;

    /// Jobs, newest first.
    async fn jobs(
        &self,
        reach: &Reach,
        filter: &JobFilter,
        page: &Page,
    ) -> Result<Vec<JobRow>, StoreError>;

    /// Removes a job, its result and its history, whatever its status: the worker
    /// of a running one loses its lease. `false`: there is none.
    async fn delete_job(&self, reach: &Reach, id: &str) -> Result<bool, StoreError>;

    /// Removes jobs that ended longer than `age` ago, measurements stored longer
    /// ago that no job works on, and idempotency keys as old; at most `limit` of
    /// each, so that nobody waits long for the write lock.
    async fn delete_older(&self, age: Duration, limit: u32) -> Result<Expired, StoreError>;

    /// JSON of a job's result, once it has one.
    async fn result(&self, reach: &Reach, id: &str) -> Result<Option<String>, StoreError>;

    /// At most `limit` results with what they are of, latest measured first; of those
    /// measured at one time, latest submitted first.
    async fn results(
        &self,
        reach: &Reach,
        filter: &ResultFilter,
        limit: u32,
    ) -> Result<Vec<StoredResult>, StoreError>;

    /// At most `limit` axes that measurements name, by machine and axis; of one
    /// machine, or of every one.
    async fn axes(
        &self,
        reach: &Reach,
        machine: Option<&str>,
        limit: u32,
    ) -> Result<Vec<AxisRow>, StoreError>;

    /// Convergence history of a job's latest attempt, in order.
    async fn convergence(
        &self,
        reach: &Reach,
        id: &str,
    ) -> Result<Vec<ConvergencePoint>, StoreError>;

    /// At most `limit` rows of convergence history of all attempts from position
    /// `from` on, in order.
    async fn history(
        &self,
        reach: &Reach,
        id: &str,
        from: i64,
        limit: u32,
    ) -> Result<Vec<ConvergencePoint>, StoreError>;

    /// What waits and what runs.
    async fn queue(&self) -> Result<QueueState, StoreError>;

    /// Cancels a queued job, or asks the worker of a running one to stop.
    async fn cancel(&self, reach: &Reach, id: &str) -> Result<Cancelling, StoreError>;

    /// Leases the queued job whose turn it is for `duration` to a worker, if there is one and the
    /// worker may have it beside what it has in hand. `worker` tells processes apart.
    async fn lease(&self, worker: &str, duration: Duration) -> Result<Option<Lease>, StoreError>;

    /// Renews a lease and stores what has happened since the last time.
    /// `progress` is JSON; `None` leaves it as it is.
    async fn heartbeat(
        &self,
        lease: &Lease,
        duration: Duration,
        progress: Option<&str>,
        rows: &[ConvergencePoint],
    ) -> Result<Beat, StoreError>;

    /// Ends a job. `false`: the lease is no longer valid, nothing was written.
    async fn finish(&self, lease: &Lease, outcome: &Outcome) -> Result<bool, StoreError>;

    /// Returns a job to the queue in good order; the attempt is not charged.
    /// `false`: the lease is no longer valid, nothing was written.
    async fn hand_back(&self, lease: &Lease) -> Result<bool, StoreError>;

    /// Requeues jobs whose lease has expired, or ends them: as cancelled where
    /// that was asked for, as failed after [`MAX_ATTEMPTS`] charges. `wait` is how long a job is
    /// kept from the queue after the second death of its worker; each further wait is four times
    /// as long. On Postgres a process that found none looks again after a second.
    async fn recover_expired(&self, wait: Duration) -> Result<Recovered, StoreError>;
}
