//! Rows of jobs: what they ask for, and where they stand.

use super::Millis;

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
    pub(in crate::store) fn rank(self) -> i64 {
        match self {
            Self::Low => 0,
            Self::Normal => 2,
            Self::High => 4,
        }
    }
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
    /// As [`MeasurementFilter::text`](super::MeasurementFilter::text), of the measurement.
    pub text: Option<String>,
    /// The batch they are of.
    pub batch_id: Option<String>,
}
