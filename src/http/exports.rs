//! Measurements and answers as tables for other programs.

use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;

use crate::service::Service;

use super::cached;
use super::problem::Problem;

const CSV: &str = "text/csv; charset=utf-8";

/// The data of a measurement as a harmonic table, which can be uploaded again.
///
/// Units are in the lines before the header, and in the names of the columns.
/// Records are given as the harmonics that were computed from them.
#[utoipa::path(
    get, path = "/v1/measurements/{id}/data.csv", tag = "measurements",
    operation_id = "get_measurement_csv",
    params(
        ("id" = String, Path, description = "Id of the measurement"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = 304, description = "The data is what `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn measurement_csv(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    Ok(cached::answer(&headers, CSV, service.measurement_csv(&id).await?, true))
}

/// The same as JSON.
#[utoipa::path(
    get, path = "/v1/measurements/{id}/data.json", tag = "measurements",
    operation_id = "get_measurement_json",
    params(
        ("id" = String, Path, description = "Id of the measurement"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = Object),
        (status = 304, description = "The data is what `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn measurement_json(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let json = service.measurement_json(&id).await?;
    Ok(cached::answer(&headers, "application/json", json, true))
}

/// The parameters of a result, one row each with its interval and unit.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/parameters.csv", tag = "jobs", operation_id = "get_parameters_csv",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = 304, description = "The table is what `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn parameters_csv(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    Ok(cached::answer(&headers, CSV, service.parameters_csv(&id).await?, true))
}

/// Measured and simulated harmonics of a result, units in the header.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/comparison.csv", tag = "jobs", operation_id = "get_comparison_csv",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = 304, description = "The table is what `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn comparison_csv(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    Ok(cached::answer(&headers, CSV, service.comparison_csv(&id).await?, true))
}
