//! `/v1/measurements/{id}/inspection`: a measurement looked at before anything is computed of it.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;
use servoscope_core::answers::Inspection;

use crate::service::Service;

use super::cached;
use super::problem::Problem;

/// What looks wrong with a measurement, and which effects it can show at which size.
///
/// It is computed when it is asked for, in a few seconds for a table and up to a minute for a long
/// record, and kept for a while.
#[utoipa::path(
    get, path = "/v1/measurements/{id}/inspection", tag = "measurements",
    operation_id = "inspect_measurement",
    params(("id" = String, Path, description = "Id of the measurement")),
    responses(
        (status = 200, body = Inspection),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    State(service): State<Service>,
    Path(id): Path<String>,
) -> Result<Json<Inspection>, Box<Problem>> {
    Ok(Json(service.inspection(&id).await?))
}

/// What was measured as an SVG: gain and phase over frequency, and one period of records over time.
#[utoipa::path(
    get, path = "/v1/measurements/{id}/measured.svg", tag = "measurements",
    operation_id = "get_measurement_figure",
    params(
        ("id" = String, Path, description = "Id of the measurement"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "image/svg+xml"),
        (status = 304, description = "The figure is the one that `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn figure(
    State(service): State<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let svg = service.measurement_figure(&id).await?;
    Ok(cached::answer(&headers, "image/svg+xml", svg, true))
}
