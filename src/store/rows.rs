//! Rows as they are stored: neither domain values nor what a client sees.

use super::MAX_ATTEMPTS;
use super::gist::Gist;

/// Milliseconds since 1970-01-01 UTC, by the database's clock.
pub type Millis = i64;

/// One file of an upload, as it came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileRow {
    /// Name used in messages.
    pub name: String,
    /// Media type of the request or part it came in.
    pub content_type: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// What is listed and shown of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementRow {
    /// UUID version 7.
    pub id: String,
    /// When it was stored; ignored on insertion.
    pub created_at_ms: Millis,
    /// Name the upload or the request gives.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Who measured.
    pub operator: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// JSON object of strings.
    pub labels: String,
    /// Hexadecimal digest of the data.
    pub sha256: String,
    /// Number of experiments.
    pub experiments: i64,
    /// Highest harmonic of any experiment.
    pub highest_harmonic: i64,
    /// Smallest magnitude, input units.
    pub magnitude_min: f64,
    /// Largest magnitude, input units.
    pub magnitude_max: f64,
    /// Lowest fundamental, rad/s.
    pub omega_min_rad_s: f64,
    /// Highest fundamental, rad/s.
    pub omega_max_rad_s: f64,
    /// JSON array: remarks of the reader.
    pub notes: String,
    /// JSON of what input and response are; `None` for a row of an earlier version.
    pub quantities: Option<String>,
    /// JSON array: names of its files in the order of the upload; ignored on insertion.
    pub files: String,
    /// What one simulation with the base model is estimated to take, s; `None` for a row of an
    /// earlier version.
    pub simulation_s: Option<f64>,
    /// What a diagnosis is estimated to take beside the search of the base model, s; likewise.
    pub diagnosis_s: Option<f64>,
}

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Waits for a worker.
    Queued,
    /// A worker holds a lease on it.
    Running,
    /// Has a result.
    Succeeded,
    /// Has a reason why there is no result.
    Failed,
    /// Was cancelled before it had a result.
    Cancelled,
}

/// Which jobs of the same submitter a job goes before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Priority {
    /// After all others.
    Low,
    /// In the order in which they came.
    #[default]
    Normal,
    /// Before all others.
    High,
}

impl Priority {
    /// Every priority, the lowest first.
    pub const ALL: [Self; 3] = [Self::Low, Self::Normal, Self::High];

    /// Its name, for people and on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Normal => "normal",
            Self::High => "high",
        }
    }

    /// As it is stored; one more: it gave its turn to another, and goes before its equals.
    pub(super) fn rank(self) -> i64 {
        match self {
            Self::Low => 0,
            Self::Normal => 2,
            Self::High => 4,
        }
    }
}

impl Status {
    /// Every status.
    pub const ALL: [Self; 5] =
        [Self::Queued, Self::Running, Self::Succeeded, Self::Failed, Self::Cancelled];

    /// Whether nothing will change any more.
    pub fn is_final(self) -> bool {
        matches!(self, Status::Succeeded | Status::Failed | Status::Cancelled)
    }

    /// Its name, for people, on the wire and in the database.
    pub fn name(self) -> &'static str {
        match self {
            Status::Queued => "queued",
            Status::Running => "running",
            Status::Succeeded => "succeeded",
            Status::Failed => "failed",
            Status::Cancelled => "cancelled",
        }
    }
}

/// What is given beside files of one layout, under a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MappingRow {
    /// Its name.
    pub name: String,
    /// JSON object of keys and values.
    pub settings: String,
    /// Layout of the files that it is for; `None`: it is used by its name alone.
    pub layout: Option<String>,
    /// When it was last stored; the store says.
    pub updated_at_ms: Millis,
}

/// A job to be queued.
#[derive(Debug, Clone, PartialEq)]
pub struct NewJobRow {
    /// UUID version 7.
    pub id: String,
    /// The measurement it works on.
    pub measurement_id: String,
    /// Whoever queues it: submitters take turns.
    pub submitter: String,
    /// Kind of job.
    pub kind: String,
    /// Which of its submitter's jobs it goes before.
    pub priority: Priority,
    /// JSON of the request, every option in effect.
    pub request: String,
}

/// A job without its result, which may be large and is read on its own.
#[derive(Debug, Clone, PartialEq)]
pub struct JobRow {
    /// UUID version 7.
    pub id: String,
    /// The measurement it works on.
    pub measurement_id: String,
    /// Kind of job.
    pub kind: String,
    /// JSON of the request, every option in effect.
    pub request: String,
    /// Where it stands.
    pub status: Status,
    /// JSON of the latest progress.
    pub progress: Option<String>,
    /// Leases so far.
    pub attempt: i64,
    /// Whether somebody asked to cancel it.
    pub cancel_requested: bool,
    /// When it was queued.
    pub created_at_ms: Millis,
    /// When its present attempt began.
    pub started_at_ms: Option<Millis>,
    /// When it became final.
    pub finished_at_ms: Option<Millis>,
    /// JSON of why it failed.
    pub failure: Option<String>,
    /// The batch it is of.
    pub batch_id: Option<String>,
}

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

/// JSON of why a job failed whose workers died too often.
pub(super) fn gave_up() -> String {
    let reason = format!(
        "gave up after {MAX_ATTEMPTS} attempts: each time the worker process ended while it ran this \
         job alone, or lost only this job, as happens when it is killed or runs out of memory; try a \
         smaller measurement or search, or ask whoever operates the server"
    );
    serde_json::json!({ "reason": reason, "reference": null }).to_string()
}

/// One row of convergence history.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergencePoint {
    /// Position within the history of the job over all its attempts, from 0.
    pub seq: i64,
    /// Stage of the computation.
    pub stage: String,
    /// Epoch, cycle or step within the stage.
    pub cycle: i64,
    /// Evaluations used by the stage.
    pub evaluations: i64,
    /// Best cost; finite.
    pub best: f64,
    /// Mean cost over the population.
    pub mean: Option<f64>,
    /// Seconds since the computation began.
    pub elapsed_s: f64,
}

/// A client's promise that requests with this key are one request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdempotencyKey {
    /// The client's key.
    pub key: String,
    /// Hexadecimal digest of what was asked.
    pub body_sha256: String,
}

/// What an insertion came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Inserted {
    /// A new resource.
    Created,
    /// The key was used before for the same request; this resource answers it.
    Replayed(String),
    /// The key was used before for another request.
    KeyReused,
}

/// A page of a list, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Page {
    /// At most this many rows.
    pub limit: u32,
    /// Only rows with a smaller id; `None`: from the newest.
    pub before: Option<String>,
}

/// Which measurements to list; `None` accepts every value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeasurementFilter {
    /// The machine.
    pub machine: Option<String>,
    /// The axis.
    pub axis: Option<String>,
    /// Labels and their values, all of which must match.
    pub labels: Vec<(String, String)>,
    /// Stored at this time or later.
    pub since_ms: Option<Millis>,
    /// Stored before this time.
    pub until_ms: Option<Millis>,
    /// Measured at this time or later, where the upload says when.
    pub measured_since_ms: Option<Millis>,
    /// Measured before this time, where the upload says when.
    pub measured_until_ms: Option<Millis>,
    /// With this text in the name, machine, axis, operator, a label or the name of a file.
    pub text: Option<String>,
    /// Digest of the data.
    pub sha256: Option<String>,
}

/// What a measurement says of itself, beside its data.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Description {
    /// Its name.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Who measured.
    pub operator: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// JSON object of labels.
    pub labels: String,
}

/// What another reading of a measurement's files changes.
#[derive(Debug, Clone, PartialEq)]
pub struct RereadRow {
    /// What was read; id, time of storing and what the measurement says of itself are ignored.
    pub row: MeasurementRow,
    /// Name of the file that carries what is given beside the others.
    pub given_name: &'static str,
    /// That file; `None`: nothing is given.
    pub given: Option<FileRow>,
}

/// What became of another reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rereading {
    /// It is stored.
    Stored,
    /// There is a job on the measurement: nothing was changed.
    HasJobs,
    /// There is no measurement with this id.
    Unknown,
}

/// Which jobs to list; `None` accepts every value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct JobFilter {
    /// Where they stand.
    pub status: Option<Status>,
    /// The measurement they work on.
    pub measurement_id: Option<String>,
    /// Kind of job.
    pub kind: Option<String>,
    /// Machine of the measurement.
    pub machine: Option<String>,
    /// Axis of the measurement.
    pub axis: Option<String>,
    /// Labels of the measurement and their values, all of which must match.
    pub labels: Vec<(String, String)>,
    /// Queued at this time or later.
    pub since_ms: Option<Millis>,
    /// Queued before this time.
    pub until_ms: Option<Millis>,
    /// Verdict of a diagnosis.
    pub verdict: Option<String>,
    /// As [`MeasurementFilter::text`], of the measurement.
    pub text: Option<String>,
    /// The batch they are of.
    pub batch_id: Option<String>,
}

/// Which results to list; `None` accepts every value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ResultFilter {
    /// The machine.
    pub machine: Option<String>,
    /// The axis.
    pub axis: Option<String>,
    /// The measurement.
    pub measurement_id: Option<String>,
    /// Measured at this time or later; stored, where the upload does not say when.
    pub from_ms: Option<Millis>,
    /// Measured before this time, likewise.
    pub to_ms: Option<Millis>,
    /// Of each measurement only the job that was submitted last.
    pub latest_only: bool,
}

/// A result with what it is of.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredResult {
    /// The job.
    pub job_id: String,
    /// JSON of the result.
    pub result: String,
    /// The measurement.
    pub measurement_id: String,
    /// Its name.
    pub name: Option<String>,
    /// Its machine.
    pub machine: Option<String>,
    /// Its axis.
    pub axis: Option<String>,
    /// When it was measured; where the upload does not say, when it was stored.
    pub at_ms: Millis,
}

/// An axis that measurements name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxisRow {
    /// The machine.
    pub machine: String,
    /// The axis.
    pub axis: String,
    /// Measurements of it.
    pub measurements: i64,
    /// Those of them with a result.
    pub results: i64,
    /// When it was first measured; stored, where the upload does not say when.
    pub first_ms: Millis,
    /// When it was last measured.
    pub last_ms: Millis,
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

/// What was removed because it was old.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Expired {
    /// Measurements, with their files.
    pub measurements: u64,
    /// Jobs, with results and history.
    pub jobs: u64,
}
