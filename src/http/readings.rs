//! `/v1/measurements/{id}/reading`: how the stored files are read.

use std::collections::BTreeMap;

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::{Extension, Json};
use serde::Deserialize;
use utoipa::ToSchema;

use crate::service::Service;

use super::body;
use super::previews::PreviewView;
use super::problem::Problem;
use super::views::MeasurementView;

/// How stored files are to be read.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ReadAgain {
    /// All that is given beside the files, by the names of the fields of an upload: `response`,
    /// `input`, `magnitude`, `column_names` … It takes the place of what was given before.
    given: BTreeMap<String, String>,
}

/// How stored files would be read.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PreviewAgain {
    /// As for another reading; left out: what was given with the upload.
    given: Option<BTreeMap<String, String>>,
}

/// Reads the stored files of a measurement again: in other units, as another kind of response, with
/// other columns.
///
/// It is possible until a job is queued on the measurement: results depend on how its files were
/// read. Name, machine, axis, operator, time and labels stay as they are. Files that cannot be read
/// like that change nothing.
#[utoipa::path(
    put, path = "/v1/measurements/{id}/reading", tag = "measurements", operation_id = "read_again",
    params(("id" = String, Path, description = "Id of the measurement")),
    request_body = ReadAgain,
    responses(
        (status = 200, body = MeasurementView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn read_again(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<MeasurementView>, Box<Problem>> {
    let ReadAgain { given } = body::json(&headers, &body)?;
    Ok(Json(service.read_again(&id, given).await?.into()))
}

/// Says how the stored files of a measurement would be read, and stores nothing.
#[utoipa::path(
    post, path = "/v1/measurements/{id}/preview", tag = "measurements",
    operation_id = "preview_reading",
    params(("id" = String, Path, description = "Id of the measurement")),
    request_body = PreviewAgain,
    responses(
        (status = 200, body = PreviewView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn preview(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<PreviewView>, Box<Problem>> {
    let PreviewAgain { given } = body::json(&headers, &body)?;
    Ok(Json(service.preview_reading(&id, given).await?.into()))
}
