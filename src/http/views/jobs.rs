//! Jobs as a client asks for them and sees them.

use serde::{Deserialize, Serialize};
use servoscope_core::answers::{
    ConvergenceRow, IdentifyOptions, JobKind, Method, PlantRequest, Progress,
};
use utoipa::ToSchema;

use crate::service::Job;
use crate::store::{Priority, Status};

use super::rfc3339;

/// State of a job.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::http) enum JobStatus {
    /// Waits for a worker.
    Queued,
    /// Is being computed.
    Running,
    /// Has a result.
    Succeeded,
    /// Has a `failure`.
    Failed,
    /// Was cancelled.
    Cancelled,
}

impl From<Status> for JobStatus {
    fn from(status: Status) -> Self {
        match status {
            Status::Queued => Self::Queued,
            Status::Running => Self::Running,
            Status::Succeeded => Self::Succeeded,
            Status::Failed => Self::Failed,
            Status::Cancelled => Self::Cancelled,
        }
    }
}

impl From<JobStatus> for Status {
    fn from(status: JobStatus) -> Self {
        match status {
            JobStatus::Queued => Self::Queued,
            JobStatus::Running => Self::Running,
            JobStatus::Succeeded => Self::Succeeded,
            JobStatus::Failed => Self::Failed,
            JobStatus::Cancelled => Self::Cancelled,
        }
    }
}

/// Which jobs of the same key a job goes before; without keys, of the same address.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
#[schema(as = Priority)]
pub(in crate::http) enum PriorityView {
    /// It waits for all others.
    Low,
    /// In the order in which they came.
    Normal,
    /// It goes before all others.
    High,
}

impl From<Priority> for PriorityView {
    fn from(priority: Priority) -> Self {
        match priority {
            Priority::Low => Self::Low,
            Priority::Normal => Self::Normal,
            Priority::High => Self::High,
        }
    }
}

/// Why a job failed.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Failure)]
pub(in crate::http) struct FailureView {
    /// In words.
    reason: String,
    /// Where the operator finds more in the log; null where `reason` says all.
    reference: Option<String>,
}

/// A job.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Job)]
pub(in crate::http) struct JobView {
    /// Its id.
    pub(in crate::http) id: String,
    /// The measurement it works on.
    measurement_id: String,
    /// The batch that it belongs to; null: it was submitted on its own.
    batch_id: Option<String>,
    /// Kind of job.
    kind: JobKind,
    /// Its state.
    status: JobStatus,
    /// How far it has come; null before it begins.
    progress: Option<Progress>,
    /// Why it failed; null unless it did.
    failure: Option<FailureView>,
    /// Whether it was asked to stop.
    cancel_requested: bool,
    /// What was said of the plant; null: the order is chosen from the data.
    plant: Option<PlantRequest>,
    /// The method in effect.
    method: Method,
    /// The measurement on which a diagnosis measures its improvement; null: none.
    validation_measurement_id: Option<String>,
    /// Which jobs of the same key it goes before.
    priority: PriorityView,
    /// Every option in effect.
    options: IdentifyOptions,
    /// What it was estimated to take, seconds of one processor, to within a factor of ten; null for a
    /// job that an earlier version stored.
    estimated_s: Option<f64>,
    /// How often it was begun.
    attempt: i64,
    /// When it was queued, RFC 3339.
    created_at: Option<String>,
    /// When its latest attempt began, RFC 3339.
    started_at: Option<String>,
    /// When it ended, RFC 3339.
    finished_at: Option<String>,
}

impl From<Job> for JobView {
    fn from(Job { row, request, progress, failure }: Job) -> Self {
        Self {
            id: row.id,
            measurement_id: row.measurement_id,
            batch_id: row.batch_id,
            kind: request.kind,
            status: row.status.into(),
            progress,
            failure: failure.map(|failure| FailureView {
                reason: failure.reason,
                reference: failure.reference,
            }),
            cancel_requested: row.cancel_requested,
            plant: request.plant,
            method: request.method,
            validation_measurement_id: request.validation_measurement_id,
            priority: request.priority.into(),
            options: request.options,
            estimated_s: request.estimated_s,
            attempt: row.attempt,
            created_at: rfc3339(row.created_at_ms),
            started_at: row.started_at_ms.and_then(rfc3339),
            finished_at: row.finished_at_ms.and_then(rfc3339),
        }
    }
}

/// What a job asks for.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::http) struct SubmitJob {
    /// The measurement to work on.
    pub(in crate::http) measurement_id: String,
    /// Kind of job.
    #[schema(value_type = JobKind)]
    pub(in crate::http) kind: String,
    /// What is known of the plant; left out: the order is chosen from the data.
    pub(in crate::http) plant: Option<PlantRequest>,
    /// How parameters are estimated; left out: `abc-ann`.
    #[schema(value_type = Option<Method>)]
    pub(in crate::http) method: Option<String>,
    /// A second measurement of the same axis, on which a `diagnose` job measures
    /// the improvement by its causes.
    pub(in crate::http) validation_measurement_id: Option<String>,
    /// Which waiting jobs of the same key it goes before; left out: `normal`. Keys take turns
    /// whatever the priorities of their jobs.
    #[schema(value_type = Option<PriorityView>)]
    pub(in crate::http) priority: Option<String>,
    /// Options of the method; each one left out takes its default.
    pub(in crate::http) options: Option<IdentifyOptions>,
}

/// Convergence history of a job.
#[derive(Debug, Serialize, ToSchema)]
pub(in crate::http) struct Convergence {
    /// In order.
    pub(in crate::http) rows: Vec<ConvergenceRow>,
}
