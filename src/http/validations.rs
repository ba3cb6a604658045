//! `/v1/validations`.

use axum::body::Bytes;
use axum::http::HeaderMap;
use axum::{Extension, Json};
use serde::Deserialize;
use servoscope_core::answers::Validation;
use utoipa::ToSchema;

use crate::service::Service;

use super::body;
use super::problem::Problem;

/// Which result is tried on which measurement.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Validate {
    /// A job that has succeeded, of either kind.
    job_id: String,
    /// The measurement that its models are simulated on.
    measurement_id: String,
}

/// Tries the models of a result on another measurement.
///
/// Nothing is fitted and nothing is stored: the base model and the one with the
/// causes are simulated on the inputs of the measurement and compared with its
/// response.
#[utoipa::path(
    post, path = "/v1/validations", tag = "jobs", operation_id = "validate",
    request_body = Validate,
    responses(
        (status = 200, body = Validation),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "404 for an unknown job or measurement, or a job that ended without a \
                        result; 409 until the job has ended; 422 where its models cannot be \
                        tried on the measurement"),
    )
)]
pub(super) async fn create(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<Validation>, Box<Problem>> {
    let Validate { job_id, measurement_id } = body::json(&headers, &body)?;
    Ok(Json(service.validate(&job_id, &measurement_id).await?))
}
