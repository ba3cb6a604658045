//! The queue: leases, what becomes of a job whose worker dies, and whose turn it is.
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
//! A turn is the submitter's: where it has a job of a higher [`Priority`](super::Priority) waiting, that
//! one is leased in the turn, and the two jobs exchange theirs. The one that gave its turn away has come
//! before its equals, and goes before them from then on; of several such the oldest. So priorities order
//! the jobs of one submitter, and take no turn from another.

use std::time::Duration;

use super::gist::Gist;
use super::{Millis, Status};

/// How often a job is charged with the death of its worker before it ends as failed.
pub const MAX_ATTEMPTS: u32 = 3;

/// Deaths of workers that a job shares with others before it runs alone.
pub const ALONE_AFTER: u32 = 3;

/// How long it runs before others begin beside it; four times as long after each further such death.
pub const ALONE_FOR: Duration = Duration::from_secs(15);

/// The longest that a job waits after a death of its worker, unless the first wait is longer.
pub const LONGEST_WAIT: Duration = Duration::from_secs(600);

/// The right to work on a job until it expires; every write names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    /// The job.
    pub job_id: String,
    /// Number of the lease, never used twice for a job.
    pub attempt: i64,
    /// Position of the first row of history that this attempt adds.
    pub next_seq: i64,
    /// The measurement the job works on.
    pub measurement_id: String,
    /// Kind of job.
    pub kind: String,
    /// JSON of the request.
    pub request: String,
}

/// How a job ends, decided by the worker that holds its lease.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// JSON of the result.
    Succeeded(String),
    /// JSON of the reason.
    Failed(String),
    /// The computation stopped because it was asked to.
    Cancelled,
}

impl Outcome {
    /// Where it leaves the job.
    pub fn status(&self) -> Status {
        match self {
            Outcome::Succeeded(_) => Status::Succeeded,
            Outcome::Failed(_) => Status::Failed,
            Outcome::Cancelled => Status::Cancelled,
        }
    }

    /// What it leaves in the columns `result` and `failure`.
    pub(super) fn columns(&self) -> (Option<&str>, Option<&str>) {
        match self {
            Outcome::Succeeded(result) => (Some(result), None),
            Outcome::Failed(failure) => (None, Some(failure)),
            Outcome::Cancelled => (None, None),
        }
    }

    /// What stands out of it.
    pub(super) fn gist(&self) -> Gist {
        match self {
            Outcome::Succeeded(result) => Gist::of(result),
            Outcome::Failed(_) | Outcome::Cancelled => Gist::default(),
        }
    }
}

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
    pub(super) fn count(&mut self, left: EndedRow) {
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

/// What waits and what runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QueueState {
    /// Jobs that wait for a worker.
    pub queued: i64,
    /// Jobs that a worker holds.
    pub running: i64,
    /// How long the oldest job has waited; 0 where none waits.
    pub oldest_wait_ms: Millis,
}

/// A job that ended because its lease expired.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EndedRow {
    /// Kind of job.
    pub kind: String,
    /// How it ended.
    pub status: Status,
}

/// JSON of why a job failed whose workers died too often.
pub(super) fn gave_up() -> String {
    let reason = format!(
        "stopped after {MAX_ATTEMPTS} attempts: each time the worker process ended while it computed \
         this job, most likely because it ran out of memory or was killed. Try fewer experiments or \
         harmonics, or ask whoever operates the server"
    );
    serde_json::json!({ "reason": reason, "reference": null }).to_string()
}
