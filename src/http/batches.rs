//! `/v1/batches`.

mod views;

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::service::{BatchSubmission, Service, Submission};

use super::lists::DEFAULT_PAGE;
use super::measurements::idempotency_key;
use super::problem::Problem;
use super::query::Query;
use super::server::Peer;
use super::views::List;
use super::{body, flat};
use views::{BatchJobState, COLUMNS, SubmitBatch};

pub(super) use views::{BatchJobView, BatchView};

/// Queues a job for each of many measurements, as one batch.
///
/// All of them are queued, or none. The jobs take turns with those of others as if they had been
/// submitted one by one: a batch delays another's job by one job a worker.
#[utoipa::path(
    post, path = "/v1/batches", tag = "batches", operation_id = "submit_batch",
    params(
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255,
         pattern = "^[!-~]*$",
         description = "The same key with the same request again answers with the same batch"),
    ),
    request_body = SubmitBatch,
    responses(
        (status = 202, body = BatchView,
         headers(("Location" = String, description = "Where the batch is"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "`member` names the first measurement that cannot be used"),
    )
)]
pub(super) async fn submit(
    Extension(service): Extension<Service>,
    Extension(Peer(address)): Extension<Peer>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let key = idempotency_key(&headers)?;
    let asked: SubmitBatch = body::json(&headers, &body)?;
    let each = Submission {
        submitter: address.to_string(),
        kind: asked.kind,
        actuator_order: asked.plant.map(|plant| plant.actuator_order),
        method: asked.method,
        priority: asked.priority,
        options: asked.options.unwrap_or_default(),
        ..Submission::default()
    };
    let SubmitBatch { name, measurement_ids, .. } = asked;
    let submission = BatchSubmission { name, measurement_ids, each };
    let view = BatchView::from(service.submit_batch(&submission, key).await?.resource);
    let location = [(header::LOCATION, format!("/v1/batches/{}", view.id))];
    Ok((StatusCode::ACCEPTED, location, Json(view)).into_response())
}

/// Query of a list of batches.
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
}

/// Batches, newest first.
#[utoipa::path(
    get, path = "/v1/batches", tag = "batches", operation_id = "list_batches",
    params(ListQuery),
    responses(
        (status = 200, body = List<BatchView>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
    Query(query): Query<ListQuery>,
) -> Result<Json<List<BatchView>>, Box<Problem>> {
    let limit = query.limit.unwrap_or(DEFAULT_PAGE);
    Ok(Json(List::new(service.batches(limit, query.cursor).await?)))
}

/// A batch as it stands: how far it has come, and what came of it so far.
#[utoipa::path(
    get, path = "/v1/batches/{id}", tag = "batches", operation_id = "get_batch",
    params(("id" = String, Path, description = "Id of the batch")),
    responses(
        (status = 200, body = BatchView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<BatchView>, Box<Problem>> {
    Ok(Json(service.batch(&id).await?.into()))
}

/// Query of what came of a batch.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ResultsQuery {
    /// Largest number of items; 50 if left out.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
    /// `next` of the page before.
    #[param(format = "uuid")]
    cursor: Option<String>,
    /// Only those whose job is in this state.
    #[param(inline)]
    state: Option<BatchJobState>,
}

/// What came of each measurement so far, in the order of the request.
#[utoipa::path(
    get, path = "/v1/batches/{id}/results", tag = "batches", operation_id = "list_batch_results",
    params(("id" = String, Path, description = "Id of the batch"), ResultsQuery),
    responses(
        (status = 200, body = List<BatchJobView>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn results(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    Query(query): Query<ResultsQuery>,
) -> Result<Json<List<BatchJobView>>, Box<Problem>> {
    let limit = query.limit.unwrap_or(DEFAULT_PAGE);
    let standing = query.state.map(Into::into);
    Ok(Json(List::new(service.batch_jobs(&id, standing, limit, query.cursor).await?)))
}

/// The same as a table, of all measurements at once.
#[utoipa::path(
    get, path = "/v1/batches/{id}/results.csv", tag = "batches",
    operation_id = "list_batch_results_csv",
    params(("id" = String, Path, description = "Id of the batch")),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn results_csv(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Response, Box<Problem>> {
    let rows = service.batch_table(&id).await?.into_iter();
    flat::csv(&COLUMNS, &rows.map(BatchJobView::from).collect::<Vec<_>>())
}

/// Cancels the jobs of a batch that have not ended.
///
/// Those that wait end at once, those that run at their next evaluation. What has ended stays as it
/// is, and cancelling twice is no error.
#[utoipa::path(
    post, path = "/v1/batches/{id}/cancel", tag = "batches", operation_id = "cancel_batch",
    params(("id" = String, Path, description = "Id of the batch")),
    responses(
        (status = 202, body = BatchView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn cancel(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Response, Box<Problem>> {
    let batch = service.cancel_batch(&id).await?;
    Ok((StatusCode::ACCEPTED, Json(BatchView::from(batch))).into_response())
}

/// Removes a batch, its jobs and their results, for good. Its measurements stay. What runs is
/// stopped.
#[utoipa::path(
    delete, path = "/v1/batches/{id}", tag = "batches", operation_id = "delete_batch",
    params(("id" = String, Path, description = "Id of the batch")),
    responses(
        (status = 204, description = "It is gone"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn delete(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.delete_batch(&id).await?;
    Ok(StatusCode::NO_CONTENT)
}
