//! The service itself: whether it lives, whether it is ready, what it offers.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};

use crate::service::Service;

use super::problem::Problem;
use super::routes;

/// Whether the process answers at all.
#[utoipa::path(
    get, path = "/livez", tag = "service", operation_id = "live",
    responses((status = 200, body = String, content_type = "text/plain"))
)]
pub(super) async fn live() -> &'static str {
    "ok\n"
}

/// Whether requests can be served.
#[utoipa::path(
    get, path = "/readyz", tag = "service", operation_id = "ready",
    responses(
        (status = 200, body = String, content_type = "text/plain"),
        (status = 503, body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn ready(
    Extension(service): Extension<Service>,
) -> Result<&'static str, Box<Problem>> {
    service.ready().await?;
    Ok("ok\n")
}

/// What an operator watches: queue, jobs, evaluations, requests.
#[utoipa::path(
    get, path = "/metrics", tag = "service", operation_id = "metrics",
    responses(
        (status = 200, body = String, content_type = "application/openmetrics-text"),
        (status = 503, body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn metrics(
    Extension(service): Extension<Service>,
) -> Result<Response, Box<Problem>> {
    let media_type = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    let text = service.metrics_text().await?;
    Ok(([(header::CONTENT_TYPE, media_type)], text).into_response())
}

/// The OpenAPI document of this service.
#[utoipa::path(
    get, path = "/openapi.json", tag = "service", operation_id = "openapi_document",
    responses((status = 200, body = Object))
)]
pub(super) async fn document() -> Json<utoipa::openapi::OpenApi> {
    Json(routes::openapi())
}
