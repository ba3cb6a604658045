//! Batches as a client sees them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use servoscope_core::answers::{IdentifyOptions, JobKind, Method, PlantRequest};
use utoipa::ToSchema;

use crate::http::views::{PriorityView, rfc3339};
use crate::service::{Batch, BatchJob, BatchState, Counts};
use crate::store::{FailureRow, Standing, Status};

/// What is to be computed of many measurements, in the same way of each.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SubmitBatch {
    /// Its name, for people.
    #[schema(max_length = 200)]
    pub(super) name: Option<String>,
    /// The measurements, each of which gets a job; each is named once.
    #[schema(min_items = 1, max_items = 10000)]
    pub(super) measurement_ids: Vec<String>,
    /// Kind of its jobs.
    #[schema(value_type = JobKind)]
    pub(super) kind: String,
    /// What is known of the plant; left out: the order is chosen from the data.
    pub(super) plant: Option<PlantRequest>,
    /// How parameters are estimated; left out: `abc-ann`.
    #[schema(value_type = Option<Method>)]
    pub(super) method: Option<String>,
    /// Which waiting jobs of the same key its jobs go before; left out: `normal`.
    #[schema(value_type = Option<PriorityView>)]
    pub(super) priority: Option<String>,
    /// Options of the method; each one left out takes its default.
    pub(super) options: Option<IdentifyOptions>,
}

/// State of a batch.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
#[schema(as = BatchState)]
enum StateView {
    /// None of its jobs has begun.
    Queued,
    /// Some of its jobs have begun, and some have not ended.
    Running,
    /// All of its jobs have ended or are gone.
    Ended,
}

/// How many jobs of a batch stand where.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = BatchCounts)]
struct CountsView {
    /// They wait for a worker.
    queued: i64,
    /// They are computed.
    running: i64,
    /// They have a result.
    succeeded: i64,
    /// They have a reason why there is no result.
    failed: i64,
    /// They were cancelled.
    cancelled: i64,
    /// They were deleted, by themselves or with their measurement.
    deleted: i64,
}

/// Why jobs of a batch failed.
#[derive(Debug, Serialize, ToSchema)]
struct BatchFailure {
    /// In words.
    reason: String,
    /// How many for this reason.
    jobs: i64,
}

/// A batch: many measurements that are computed in the same way.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Batch)]
pub(in crate::http) struct BatchView {
    /// Its id.
    pub(super) id: String,
    /// Its name.
    name: Option<String>,
    /// Kind of its jobs.
    kind: JobKind,
    /// Its state.
    #[schema(inline)]
    state: StateView,
    /// How many jobs it had at first.
    jobs: i64,
    /// How many of them stand where.
    counts: CountsView,
    /// How many results have which verdict; `not_tested`: `adequate`, as the data were too few for
    /// any test.
    verdicts: BTreeMap<String, i64>,
    /// How many results name which cause first.
    causes: BTreeMap<String, i64>,
    /// Why jobs failed, the most frequent reasons first; at most 20.
    failures: Vec<BatchFailure>,
    /// What was said of the plant; null: the order is chosen from the data.
    plant: Option<PlantRequest>,
    /// The method in effect.
    method: Method,
    /// Which jobs of the same key its jobs go before.
    priority: PriorityView,
    /// Every option in effect.
    options: IdentifyOptions,
    /// When it was made, RFC 3339.
    created_at: Option<String>,
    /// When the first of its jobs began, RFC 3339; of those that were begun again, the latest attempt.
    started_at: Option<String>,
    /// When the last of its jobs ended, RFC 3339; null until all have.
    ended_at: Option<String>,
}

impl From<Batch> for BatchView {
    fn from(batch: Batch) -> Self {
        let Batch { row, request, counts, verdicts, causes, .. } = batch;
        let Counts { queued, running, succeeded, failed, cancelled, deleted } = counts;
        let failure = |FailureRow { reason, jobs }| BatchFailure { reason, jobs };
        Self {
            id: row.id,
            name: row.name,
            kind: request.kind,
            state: match batch.state {
                BatchState::Queued => StateView::Queued,
                BatchState::Running => StateView::Running,
                BatchState::Ended => StateView::Ended,
            },
            jobs: row.jobs,
            counts: CountsView { queued, running, succeeded, failed, cancelled, deleted },
            verdicts,
            causes,
            failures: batch.failures.into_iter().map(failure).collect(),
            plant: request.plant,
            method: request.method,
            priority: request.priority.into(),
            options: request.options,
            created_at: rfc3339(row.created_at_ms),
            started_at: batch.started_ms.and_then(rfc3339),
            ended_at: batch.ended_ms.and_then(rfc3339),
        }
    }
}

/// State of a job of a batch.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum BatchJobState {
    /// It waits for a worker.
    Queued,
    /// It is computed.
    Running,
    /// It has a result.
    Succeeded,
    /// It has a reason why there is no result.
    Failed,
    /// It was cancelled.
    Cancelled,
    /// It was deleted, by itself or with its measurement.
    Deleted,
}

impl From<Option<Status>> for BatchJobState {
    fn from(status: Option<Status>) -> Self {
        match status {
            None => Self::Deleted,
            Some(Status::Queued) => Self::Queued,
            Some(Status::Running) => Self::Running,
            Some(Status::Succeeded) => Self::Succeeded,
            Some(Status::Failed) => Self::Failed,
            Some(Status::Cancelled) => Self::Cancelled,
        }
    }
}

impl From<BatchJobState> for Standing {
    fn from(state: BatchJobState) -> Self {
        match state {
            BatchJobState::Queued => Self::At(Status::Queued),
            BatchJobState::Running => Self::At(Status::Running),
            BatchJobState::Succeeded => Self::At(Status::Succeeded),
            BatchJobState::Failed => Self::At(Status::Failed),
            BatchJobState::Cancelled => Self::At(Status::Cancelled),
            BatchJobState::Deleted => Self::Deleted,
        }
    }
}

/// A measurement of a batch, and what came of it.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = BatchJob)]
pub(in crate::http) struct BatchJobView {
    /// The measurement.
    measurement_id: String,
    /// Name of its first file.
    file: Option<String>,
    /// The job.
    job_id: String,
    /// State of the job.
    #[schema(inline)]
    state: BatchJobState,
    /// Verdict of a diagnosis; null for an identification, and where there is no result.
    verdict: Option<String>,
    /// Id of the strongest cause that is named; null where none is.
    cause: Option<String>,
    /// Confidence in this cause.
    confidence: Option<f64>,
    /// Why there is no result; null where there is one, or may be.
    problem: Option<String>,
    /// Whether the data were enough to test the base model: without a test, `adequate` says nothing.
    /// Null where there is no verdict.
    tested: Option<bool>,
}

/// Names of the columns.
pub(super) const COLUMNS: [&str; 9] = [
    "measurement_id",
    "file",
    "job_id",
    "state",
    "verdict",
    "cause",
    "confidence",
    "problem",
    "tested",
];

impl From<BatchJob> for BatchJobView {
    fn from(BatchJob { row, tested, problem }: BatchJob) -> Self {
        Self {
            measurement_id: row.measurement_id,
            file: row.file,
            job_id: row.job_id,
            state: row.status.into(),
            verdict: row.verdict,
            cause: row.cause,
            confidence: row.confidence,
            problem,
            tested,
        }
    }
}
