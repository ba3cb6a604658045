//! `/v1/jobs/{id}/report.html`.

use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;

use crate::service::Service;

use super::cached;
use super::problem::Problem;

/// The answer to a job as one page for a person: verdict, causes, figures,
/// model and provenance, without script and without another file.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/report.html", tag = "jobs", operation_id = "get_report",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/html; charset=utf-8", headers(
            ("ETag" = String, description = "Tells this page from any other"),
        )),
        (status = 304, description = "The page is the one that `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "409 until the job has ended, 404 where it ended without a result"),
    )
)]
pub(super) async fn get(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let page = service.report(&id).await?;
    Ok(cached::answer(&headers, "text/html; charset=utf-8", page, true))
}
