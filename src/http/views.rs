//! Resources as a client sees them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use servoscope_core::answers::{
    ConvergenceRow, IdentifyOptions, JobKind, Method, PlantRequest, Progress,
};
use utoipa::ToSchema;

use crate::service::{Job, Listed, Measured, Quantities, Quantity};
use crate::store::{AxisRow, Millis, Priority, Status};

/// A page of a list.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct List<T> {
    /// The items.
    items: Vec<T>,
    /// `cursor` of the next page; null after the last one.
    next: Option<String>,
}

impl<T> List<T> {
    pub(super) fn new<S: Into<T>>(listed: Listed<S>) -> Self {
        Self { items: listed.items.into_iter().map(Into::into).collect(), next: listed.next }
    }
}

/// A stored measurement.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Measurement)]
pub(super) struct MeasurementView {
    /// Its id.
    pub(super) id: String,
    /// When it was stored, RFC 3339.
    created_at: Option<String>,
    /// Its name.
    name: Option<String>,
    /// The machine.
    machine: Option<String>,
    /// The axis of the machine.
    axis: Option<String>,
    /// Who measured.
    operator: Option<String>,
    /// When it was measured, RFC 3339.
    measured_at: Option<String>,
    /// Labels of the upload.
    labels: BTreeMap<String, String>,
    /// Hexadecimal SHA-256 of the data.
    sha256: String,
    /// Number of experiments.
    experiments: i64,
    /// Highest harmonic of any experiment.
    highest_harmonic: i64,
    /// Smallest and largest magnitude, input units.
    magnitude_range: [f64; 2],
    /// Lowest and highest fundamental, rad/s.
    omega_range_rad_s: [f64; 2],
    /// The input; null for a measurement stored before this was kept.
    input: Option<SignalView>,
    /// The response; null for a measurement stored before this was kept.
    response: Option<SignalView>,
    /// `velocity`, `position` or `acceleration`; null for a measurement stored before this was
    /// kept.
    response_kind: Option<String>,
    /// `open` or `closed`; null where the upload does not say.
    r#loop: Option<String>,
    /// Remarks of the reader: unknown columns, dropped periods, …
    notes: Vec<String>,
    /// Names of its files.
    files: Vec<String>,
}

/// Name and unit of an input or a response.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Signal)]
pub(super) struct SignalView {
    /// `current`, `force`, `velocity` …; empty where the upload does not say.
    name: String,
    /// `A`, `N`, `rad/s` …; empty where the upload does not say.
    unit: String,
}

impl SignalView {
    /// Input, response, kind of the response and loop.
    pub(super) fn both(
        quantities: Option<Quantities>,
    ) -> (Option<Self>, Option<Self>, Option<String>, Option<String>) {
        let Some(Quantities { input, response, response_kind, r#loop }) = quantities else {
            return (None, None, None, None);
        };
        (Some(input.into()), Some(response.into()), Some(response_kind), r#loop)
    }
}

impl From<Quantity> for SignalView {
    fn from(Quantity { name, unit }: Quantity) -> Self {
        Self { name, unit }
    }
}

impl From<Measured> for MeasurementView {
    fn from(Measured { row, labels, quantities, notes, files }: Measured) -> Self {
        let (input, response, response_kind, r#loop) = SignalView::both(quantities);
        Self {
            id: row.id,
            created_at: rfc3339(row.created_at_ms),
            name: row.name,
            machine: row.machine,
            axis: row.axis,
            operator: row.operator,
            measured_at: row.measured_at,
            labels,
            sha256: row.sha256,
            experiments: row.experiments,
            highest_harmonic: row.highest_harmonic,
            magnitude_range: [row.magnitude_min, row.magnitude_max],
            omega_range_rad_s: [row.omega_min_rad_s, row.omega_max_rad_s],
            input,
            response,
            response_kind,
            r#loop,
            notes,
            files,
        }
    }
}

/// Where a job stands.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum JobStatus {
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
pub(super) enum PriorityView {
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
pub(super) struct FailureView {
    /// In words.
    reason: String,
    /// Where the operator finds more in the log; null where `reason` says all.
    reference: Option<String>,
}

/// A job.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Job)]
pub(super) struct JobView {
    /// Its id.
    pub(super) id: String,
    /// The measurement it works on.
    measurement_id: String,
    /// The batch it is of; null: it was made by itself.
    batch_id: Option<String>,
    /// Kind of job.
    kind: JobKind,
    /// Where it stands.
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
    /// The measurement on which a diagnosis measures its gain; null: none.
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

/// An axis that measurements name.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Axis {
    /// The machine.
    machine: String,
    /// The axis.
    axis: String,
    /// Measurements of it.
    measurements: i64,
    /// Those of them with a result.
    results: i64,
    /// When it was first measured, RFC 3339; stored, where the upload does not say.
    first_at: Option<String>,
    /// When it was last measured.
    last_at: Option<String>,
}

impl From<AxisRow> for Axis {
    fn from(row: AxisRow) -> Self {
        Self {
            machine: row.machine,
            axis: row.axis,
            measurements: row.measurements,
            results: row.results,
            first_at: rfc3339(row.first_ms),
            last_at: rfc3339(row.last_ms),
        }
    }
}

/// Convergence history of a job.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Convergence {
    /// In order.
    pub(super) rows: Vec<ConvergenceRow>,
}

/// What a job asks for.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SubmitJob {
    /// The measurement to work on.
    pub(super) measurement_id: String,
    /// Kind of job.
    #[schema(value_type = JobKind)]
    pub(super) kind: String,
    /// What is known of the plant; left out: the order is chosen from the data.
    pub(super) plant: Option<PlantRequest>,
    /// How parameters are estimated; left out: `abc-ann`.
    #[schema(value_type = Option<Method>)]
    pub(super) method: Option<String>,
    /// A second measurement of the same axis, on which a `diagnose` job measures
    /// what its causes gain.
    pub(super) validation_measurement_id: Option<String>,
    /// Which waiting jobs of the same key it goes before; left out: `normal`. Keys take turns
    /// whatever the priorities of their jobs.
    #[schema(value_type = Option<PriorityView>)]
    pub(super) priority: Option<String>,
    /// Options of the method; each one left out takes its default.
    pub(super) options: Option<IdentifyOptions>,
}

pub(super) fn rfc3339(millis: Millis) -> Option<String> {
    jiff::Timestamp::from_millisecond(millis).ok().map(|time| time.to_string())
}
