//! `/v1/measurements/{id}/inspection`: a measurement looked at before anything is computed of it.

use axum::extract::Path;
use axum::{Extension, Json};
use servoscope_core::answers::Inspection;

use crate::service::Service;

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
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<Inspection>, Box<Problem>> {
    Ok(Json(service.inspection(&id).await?))
}
