//! `/v1/measurements`.

use axum::extract::{Path, Request};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::service::Service;
use crate::store::MeasurementFilter;

use super::lists::{self, DEFAULT_PAGE, Label};
use super::problem::Problem;
use super::query::Query;
use super::uploads::{self, FileBody, UploadForm, UploadQuery};
use super::views::{List, MeasurementView};

/// Uploads a measurement: a harmonic table or time records, as instruments and spreadsheets write
/// them.
///
/// It is read before it is stored; what cannot be read is not stored. What a file does not say may
/// be given in the query, or as fields of the form; it takes precedence over what the file says. A
/// stored mapping is used where `mapping` names it, and where a file is of its layout and could not
/// be read without it. The notes of the measurement say how the file was understood.
#[utoipa::path(
    post, path = "/v1/measurements", tag = "measurements", operation_id = "add_measurement",
    params(
        UploadQuery,
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255,
         pattern = "^[!-~]*$",
         description = "The same key with the same data again answers with the same measurement"),
    ),
    request_body(
        description = "One file, or several as the parts of a form. The format is found from the \
                       content, whatever the media type of a file is",
        content(
            (FileBody = "text/csv"), (FileBody = "application/json"), (FileBody = "text/plain"),
            (FileBody = "text/tab-separated-values"),
            (FileBody = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"),
            (FileBody = "application/octet-stream"), (UploadForm = "multipart/form-data"),
        )
    ),
    responses(
        (status = 201, body = MeasurementView,
         headers(("Location" = String, description = "Where the measurement is"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn add(
    Extension(service): Extension<Service>,
    Query(query): Query<UploadQuery>,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Response> {
    let key = idempotency_key(&headers).map_err(IntoResponse::into_response)?;
    let upload = uploads::read(query, request).await?;
    let added = service
        .add_measurement(upload, key)
        .await
        .map_err(|error| Box::<Problem>::from(error).into_response())?;
    let view = MeasurementView::from(added.resource);
    let location = [(header::LOCATION, format!("/v1/measurements/{}", view.id))];
    Ok((StatusCode::CREATED, location, Json(view)).into_response())
}

/// One measurement: its details and contents.
#[utoipa::path(
    get, path = "/v1/measurements/{id}", tag = "measurements", operation_id = "get_measurement",
    params(("id" = String, Path, description = "Id of the measurement")),
    responses(
        (status = 200, body = MeasurementView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<MeasurementView>, Box<Problem>> {
    Ok(Json(service.measurement(&id).await?.into()))
}

/// Query of a list of measurements.
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
    /// Only of this machine.
    machine: Option<String>,
    /// Only of this axis.
    axis: Option<String>,
    /// Only with this label, `name:value`; repeated: with all of them.
    #[serde(default)]
    #[param(value_type = Vec<Label>, inline)]
    label: Vec<String>,
    /// Only those stored at this time or later, RFC 3339.
    #[param(format = DateTime)]
    since: Option<String>,
    /// Only those stored before this time.
    #[param(format = DateTime)]
    until: Option<String>,
    /// Only those measured at this time or later, as far as they say when.
    #[param(format = DateTime)]
    measured_since: Option<String>,
    /// Only those measured before this time, as far as they say when.
    #[param(format = DateTime)]
    measured_until: Option<String>,
    /// Only those with this text in the name, machine, axis, operator, a label or the name of a
    /// file; upper and lower case do not matter.
    text: Option<String>,
    /// Only measurements with this SHA-256. Two measurements with the same SHA-256 contain the same
    /// data.
    sha256: Option<String>,
}

/// Measurements, newest first.
#[utoipa::path(
    get, path = "/v1/measurements", tag = "measurements", operation_id = "list_measurements",
    params(ListQuery),
    responses(
        (status = 200, body = List<MeasurementView>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
    Query(query): Query<ListQuery>,
) -> Result<Json<List<MeasurementView>>, Box<Problem>> {
    let filter = MeasurementFilter {
        labels: lists::labels(&query.label)?,
        since_ms: lists::time("since", query.since.as_deref())?,
        until_ms: lists::time("until", query.until.as_deref())?,
        measured_since_ms: lists::time("measured_since", query.measured_since.as_deref())?,
        measured_until_ms: lists::time("measured_until", query.measured_until.as_deref())?,
        machine: query.machine,
        axis: query.axis,
        text: query.text,
        sha256: query.sha256,
    };
    let limit = query.limit.unwrap_or(DEFAULT_PAGE);
    Ok(Json(List::new(service.measurements(&filter, limit, query.cursor).await?)))
}

/// Removes a measurement, its files and every job on it, for good.
#[utoipa::path(
    delete, path = "/v1/measurements/{id}", tag = "measurements",
    operation_id = "delete_measurement",
    params(("id" = String, Path, description = "Id of the measurement")),
    responses(
        (status = 204, description = "It is gone"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn delete(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.delete_measurement(&id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// The key by which a repeated request is recognised.
pub(super) fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>, Box<Problem>> {
    let Some(value) = headers.get("idempotency-key") else { return Ok(None) };
    match value.to_str() {
        Ok(text) if (1..=255).contains(&text.len()) => Ok(Some(text.to_owned())),
        _ => Err(Problem::of_status(
            StatusCode::BAD_REQUEST,
            "the Idempotency-Key is not 1 to 255 visible ASCII characters",
        )),
    }
}

/// Media type of a request, without its parameters.
pub(super) fn media_type(headers: &HeaderMap) -> String {
    let value = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok());
    let essence = value.unwrap_or_default().split(';').next().unwrap_or_default();
    essence.trim().to_ascii_lowercase()
}
