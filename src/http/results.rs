//! What a job gives: its result, and how it converged.

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use axum::{Extension, Json};
use servoscope_core::answers::{Diagnosis, Identification};
use utoipa::ToSchema;

use crate::service::Service;

use super::cached;
use super::flat;
use super::problem::Problem;
use super::views::Convergence;

/// An identification as it is sent.
#[derive(Debug, ToSchema)]
#[schema(as = IdentificationResult)]
#[expect(dead_code, reason = "describes the JSON that is sent; nothing is made of it here")]
pub(super) struct IdentificationView {
    #[serde(flatten)]
    answer: Identification,
    /// What it comes to, in one sentence: `ADEQUATE: …`. Left out where another version stored the
    /// result and this one cannot read it.
    headline: Option<String>,
}

/// A diagnosis as it is sent.
#[derive(Debug, ToSchema)]
#[schema(as = DiagnosisResult)]
#[expect(dead_code, reason = "describes the JSON that is sent; nothing is made of it here")]
pub(super) struct DiagnosisView {
    #[serde(flatten)]
    answer: Diagnosis,
    /// The verdict in one sentence: `EXPLAINED: The simulation lacks …`. Left out where another
    /// version stored the result and this one cannot read it.
    headline: Option<String>,
}

/// The result of a job, by its kind.
#[derive(Debug, ToSchema)]
#[schema(as = JobResult)]
#[expect(dead_code, reason = "describes the JSON that is stored; nothing is made of it here")]
#[serde(untagged)]
pub(super) enum ResultView {
    /// Of a job of kind `identify`.
    Identification(Box<IdentificationView>),
    /// Of a job of kind `diagnose`.
    Diagnosis(Box<DiagnosisView>),
}

/// The result of a job that has succeeded.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/result", tag = "jobs", operation_id = "get_result",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = ResultView, headers(
            ("ETag" = String, description = "Tells this result from any other"),
        )),
        (status = 304, description = "The result is the one that `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "409 until the job has ended, 404 if it ended without a result"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    // The JSON as it was stored: every digit, and whatever version wrote it.
    let result = service.result_with_headline(&id).await?;
    Ok(cached::answer(&headers, "application/json", result, true))
}

/// Convergence history of a job's latest attempt, also while it runs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/convergence", tag = "jobs", operation_id = "get_convergence",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 200, body = Convergence),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn convergence(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<Convergence>, Box<Problem>> {
    Ok(Json(Convergence { rows: service.convergence(&id).await? }))
}

/// The same as a table.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/convergence.csv", tag = "jobs", operation_id = "get_convergence_csv",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn convergence_csv(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Response, Box<Problem>> {
    let columns = ["stage", "cycle", "evaluations", "best", "mean", "elapsed_s"];
    flat::csv(&columns, &service.convergence(&id).await?)
}
