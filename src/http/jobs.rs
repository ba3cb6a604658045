//! `/v1/jobs`.

use std::time::Duration;

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use servoscope_core::answers::{JobKind, Verdict};
use utoipa::IntoParams;

use crate::service::{Service, Submission};
use crate::store::JobFilter;

use super::body;
use super::lists::{self, DEFAULT_PAGE, Label};
use super::measurements::idempotency_key;
use super::problem::Problem;
use super::query::Query;
use super::server::Peer;
use super::views::{JobStatus, JobView, List, SubmitJob};

/// The longest that a request for a job waits: longer ones meet the limits of
/// proxies in between.
const MAX_WAIT_S: u32 = 60;

/// Seconds after which asking again makes sense.
const RETRY_AFTER_S: &str = "1";

/// Queues a job.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "jobs", operation_id = "submit_job",
    params(
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255,
         pattern = "^[!-~]*$",
         description = "The same key with the same request again answers with the same job"),
    ),
    request_body = SubmitJob,
    responses(
        (status = 202, body = JobView, headers(
            ("Location" = String, description = "Where the job is"),
            ("Retry-After" = u32, description = "Seconds after which to look"),
        )),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn submit(
    Extension(service): Extension<Service>,
    Extension(Peer(address)): Extension<Peer>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let key = idempotency_key(&headers)?;
    let submission = submission(address.to_string(), &headers, &body)?;
    let view = JobView::from(service.submit(&submission, key).await?.resource);
    let headers = [
        (header::LOCATION, format!("/v1/jobs/{}", view.id)),
        (header::RETRY_AFTER, RETRY_AFTER_S.to_owned()),
    ];
    Ok((StatusCode::ACCEPTED, headers, Json(view)).into_response())
}

/// Query of a job.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct GetQuery {
    /// Seconds to wait for the job to end before answering; at most 60 are waited.
    wait: Option<u32>,
}

/// One job as it stands, or as soon as it has ended.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "get_job",
    params(("id" = String, Path, description = "Id of the job"), GetQuery),
    responses(
        (status = 200, body = JobView, headers(
            ("Retry-After" = u32, description = "Seconds after which to look again, until it ends"),
        )),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    Query(query): Query<GetQuery>,
) -> Result<Response, Box<Problem>> {
    let patience = Duration::from_secs(query.wait.unwrap_or(0).min(MAX_WAIT_S).into());
    let job = service.job_when_ended(&id, patience).await?;
    let ended = job.row.status.is_final();
    let view = Json(JobView::from(job));
    Ok(match ended {
        true => view.into_response(),
        false => ([(header::RETRY_AFTER, RETRY_AFTER_S)], view).into_response(),
    })
}

/// Query of a list of jobs.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ListQuery {
    /// Largest number of items; 50 if left out.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
    /// `next` of the page before.
    #[param(format = "uuid")]
    cursor: Option<String>,
    /// Only jobs that stand there.
    #[param(inline)]
    status: Option<JobStatus>,
    /// Only jobs that work on this measurement.
    measurement_id: Option<String>,
    /// Only jobs of this kind.
    #[param(inline)]
    kind: Option<JobKind>,
    /// Only jobs on measurements of this machine.
    machine: Option<String>,
    /// Only jobs on measurements of this axis.
    axis: Option<String>,
    /// Only jobs on measurements with this label, `name:value`; repeated: with all
    /// of them.
    #[serde(default)]
    #[param(value_type = Vec<Label>, inline)]
    label: Vec<String>,
    /// Only those queued at this time or later, RFC 3339.
    #[param(format = DateTime)]
    since: Option<String>,
    /// Only those queued before this time.
    #[param(format = DateTime)]
    until: Option<String>,
    /// Only diagnoses with this verdict.
    #[param(inline)]
    verdict: Option<Verdict>,
    /// Only jobs on measurements with this text in the name, machine, axis, operator, a label or the
    /// name of a file; upper and lower case do not matter.
    text: Option<String>,
    /// Only jobs of this batch.
    batch_id: Option<String>,
}

/// Jobs, newest first.
#[utoipa::path(
    get, path = "/v1/jobs", tag = "jobs", operation_id = "list_jobs",
    params(ListQuery),
    responses(
        (status = 200, body = List<JobView>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
    Query(query): Query<ListQuery>,
) -> Result<Json<List<JobView>>, Box<Problem>> {
    let filter = JobFilter {
        labels: lists::labels(&query.label)?,
        since_ms: lists::time("since", query.since.as_deref())?,
        until_ms: lists::time("until", query.until.as_deref())?,
        status: query.status.map(Into::into),
        measurement_id: query.measurement_id,
        kind: query.kind.map(|kind| kind.name().to_owned()),
        machine: query.machine,
        axis: query.axis,
        verdict: query.verdict.map(|verdict| verdict.name().to_owned()),
        text: query.text,
        batch_id: query.batch_id,
    };
    let limit = query.limit.unwrap_or(DEFAULT_PAGE);
    Ok(Json(List::new(service.jobs(&filter, limit, query.cursor).await?)))
}

/// Removes a job, its result and its history, for good. One that runs is stopped.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "delete_job",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 204, description = "It is gone"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn delete(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.delete_job(&id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Cancels a job.
///
/// A queued one ends at once, a running one at its next evaluation. Cancelling
/// twice is no error.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "jobs", operation_id = "cancel_job",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 202, body = JobView),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "409 where the job has already succeeded or failed"),
    )
)]
pub(super) async fn cancel(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Response, Box<Problem>> {
    let job = service.cancel(&id).await?;
    Ok((StatusCode::ACCEPTED, Json(JobView::from(job))).into_response())
}

fn submission(
    submitter: String,
    headers: &HeaderMap,
    body: &[u8],
) -> Result<Submission, Box<Problem>> {
    let job: SubmitJob = body::json(headers, body)?;
    Ok(Submission {
        submitter,
        measurement_id: job.measurement_id,
        kind: job.kind,
        actuator_order: job.plant.map(|plant| plant.actuator_order),
        method: job.method,
        validation_measurement_id: job.validation_measurement_id,
        priority: job.priority,
        options: job.options.unwrap_or_default(),
    })
}
