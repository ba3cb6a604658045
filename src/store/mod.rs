//! Measurements, jobs, results, convergence history, the queue, and what is to be told.
//!
//! [`Store`] is the whole interface; an engine implements it in a folder of its
//! own, with its SQL in sight, and must pass the tests of `contract`.
//!
//! How jobs are given to workers is told in `queue`.

mod backup;
mod batches;
#[cfg(test)]
mod contract;
mod decode;
mod error;
mod gist;
mod keys;
mod mappings;
mod outbox;
mod postgres;
mod queue;
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
pub use mappings::{MappingRow, Mappings};
pub use outbox::{DeliveryRow, DueRow, EventRow, NewDeliveryRow, Outbox, Settled, WebhookRow};
pub use postgres::Postgres;
pub use queue::{
    ALONE_AFTER, ALONE_FOR, Beat, Cancelling, EndedRow, LONGEST_WAIT, Lease, MAX_ATTEMPTS, Outcome,
    QueueState, Recovered, Wake,
};
pub use reach::Reach;
pub use rows::{
    AxisRow, ConvergencePoint, Description, Expired, FileRow, IdempotencyKey, Inserted, JobFilter,
    JobRow, MeasurementFilter, MeasurementRow, Millis, NewJobRow, Page, Priority, RereadRow,
    Rereading, ResultFilter, Status, StoredResult,
};
pub use sqlite::Sqlite;
pub use usage::Usage;

/// Everything that is kept. Every method is one transaction.
///
/// What a caller asks for takes the [`Reach`] of the caller. The methods without one are for the
/// server's own work: the queue, and what is old.
#[async_trait]
pub trait Store: Outbox + Keyring + Batches + Mappings + Portable + Send + Sync + 'static {
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
