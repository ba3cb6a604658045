//! `/v1/measurements`.

use axum::Json;
use axum::body::Bytes;
use axum::extract::{FromRequest, Multipart, Path, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::service::{Service, Upload};
use crate::store::{FileRow, MeasurementFilter};

use super::body;
use super::lists::{self, DEFAULT_PAGE};
use super::problem::Problem;
use super::query::Query;
use super::views::{List, MeasurementView};

/// Query of an upload.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct AddQuery {
    /// Name of the measurement and of its file in messages.
    name: Option<String>,
    /// Magnitude of the input at every frequency, for a table that has no column of it.
    magnitude: Option<String>,
    /// What the input is: `current A`.
    input: Option<String>,
    /// What the response is: `velocity rad/s`, `position mm`, `acceleration m/s²`.
    response: Option<String>,
    /// Whether the axis was measured in an `open` or a `closed` loop.
    r#loop: Option<String>,
    /// What amplitudes are: `peak`, `rms` or `peak-to-peak`.
    amplitude: Option<String>,
    /// Period of a time record, seconds, or `none`.
    period_s: Option<String>,
    /// Decimal mark of the numbers in a text: `comma` or `point`.
    decimal: Option<String>,
    /// Names of the columns in their order, with units in brackets, between semicolons; empty for
    /// a column that is not to be used.
    column_names: Option<String>,
    /// Time between samples, seconds, for a record that has no column of times.
    sample_s: Option<String>,
    /// Sheet of a workbook that has several tables.
    sheet: Option<String>,
    /// Whether the response has the opposite sign, as a loop gain at an injection point has: `yes`
    /// or `no`.
    inverted: Option<String>,
}

impl AddQuery {
    /// An upload of no file yet, with what the query gives.
    fn upload(self) -> Upload {
        let given = [
            ("magnitude", self.magnitude),
            ("input", self.input),
            ("response", self.response),
            ("loop", self.r#loop),
            ("amplitude", self.amplitude),
            ("period_s", self.period_s),
            ("decimal", self.decimal),
            ("column_names", self.column_names),
            ("sample_s", self.sample_s),
            ("sheet", self.sheet),
            ("inverted", self.inverted),
        ];
        let given = given.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?)));
        Upload { name: self.name, given: given.collect(), files: Vec::new() }
    }
}

/// Media types of a body that is one file, and the extension of its name.
const FILES: [(&str, &str); 6] = [
    ("text/csv", "csv"),
    ("application/json", "json"),
    ("text/plain", "txt"),
    ("text/tab-separated-values", "tsv"),
    ("application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", "xlsx"),
    ("application/octet-stream", "bin"),
];

/// Uploads a measurement: a harmonic table or time records, as instruments and spreadsheets write
/// them.
///
/// It is read before it is stored; what cannot be read is not stored. What a file does not say may
/// be given in the query, or as fields of the form; it holds before what the file says. The notes
/// of the measurement say how the file was understood.
#[utoipa::path(
    post, path = "/v1/measurements", tag = "measurements", operation_id = "add_measurement",
    params(
        AddQuery,
        ("Idempotency-Key" = Option<String>, Header,
         description = "The same key with the same data again answers with the same measurement"),
    ),
    request_body(
        description = "One file, or several as the parts of a form. The format is found from the \
                       content, whatever the media type of a file is",
        content(
            (String = "text/csv"), (Object = "application/json"), (String = "text/plain"),
            (String = "text/tab-separated-values"),
            (String = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"),
            (String = "application/octet-stream"), (Object = "multipart/form-data"),
        )
    ),
    responses(
        (status = 201, body = MeasurementView,
         headers(("Location" = String, description = "Where the measurement is"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn add(
    State(service): State<Service>,
    Query(query): Query<AddQuery>,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Response> {
    let key = idempotency_key(&headers).map_err(IntoResponse::into_response)?;
    let upload = upload(query.upload(), request).await?;
    let added = service
        .add_measurement(upload, key)
        .await
        .map_err(|error| Box::<Problem>::from(error).into_response())?;
    let view = MeasurementView::from(added.resource);
    let location = [(header::LOCATION, format!("/v1/measurements/{}", view.id))];
    Ok((StatusCode::CREATED, location, Json(view)).into_response())
}

/// One measurement: what it says of itself and what is in it.
#[utoipa::path(
    get, path = "/v1/measurements/{id}", tag = "measurements", operation_id = "get_measurement",
    params(("id" = String, Path, description = "Id of the measurement")),
    responses(
        (status = 200, body = MeasurementView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    State(service): State<Service>,
    Path(id): Path<String>,
) -> Result<Json<MeasurementView>, Box<Problem>> {
    Ok(Json(service.measurement(&id).await?.into()))
}

/// Query of a list of measurements.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ListQuery {
    /// At most so many items; 50 if left out.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
    /// `next` of the page before.
    cursor: Option<String>,
    /// Only of this machine.
    machine: Option<String>,
    /// Only of this axis.
    axis: Option<String>,
    /// Only with this label, `name:value`; repeated: with all of them.
    #[serde(default)]
    label: Vec<String>,
    /// Only those stored at this time or later, RFC 3339.
    since: Option<String>,
    /// Only those stored before this time.
    until: Option<String>,
    /// Only those measured at this time or later, as far as they say when.
    measured_since: Option<String>,
    /// Only those measured before this time, as far as they say when.
    measured_until: Option<String>,
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
    State(service): State<Service>,
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
    State(service): State<Service>,
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

async fn upload(mut upload: Upload, request: Request) -> Result<Upload, Response> {
    let content_type = media_type(request.headers());
    if content_type == "multipart/form-data" {
        return form(upload, request).await;
    }
    let Some((_, extension)) = FILES.iter().find(|(known, _)| *known == content_type) else {
        let known: Vec<&str> = FILES.iter().map(|(known, _)| *known).collect();
        let readable = format!("{}, or several files as multipart/form-data", known.join(", "));
        return Err(body::not_read(&content_type, &readable).into_response());
    };
    let bytes = Bytes::from_request(request, &()).await.map_err(IntoResponse::into_response)?;
    let stem = upload.name.as_deref().unwrap_or("upload");
    let suffix = format!(".{extension}");
    let name = if stem.ends_with(&suffix) { stem.to_owned() } else { format!("{stem}{suffix}") };
    upload.files.push(FileRow { name, content_type, bytes: bytes.into() });
    Ok(upload)
}

/// The parts of a form: files, and fields of metadata without a file name.
async fn form(mut upload: Upload, request: Request) -> Result<Upload, Response> {
    let mut parts =
        Multipart::from_request(request, &()).await.map_err(IntoResponse::into_response)?;
    while let Some(part) = parts.next_field().await.map_err(IntoResponse::into_response)? {
        let field = part.name().filter(|name| part.file_name().is_none() && Upload::can_give(name));
        if let Some(key) = field.map(str::to_owned) {
            let value = part.text().await.map_err(IntoResponse::into_response)?;
            upload.given.insert(key, value);
            continue;
        }
        let position = upload.files.len() + 1;
        let file_name = part.file_name().or(part.name()).map(str::to_owned);
        let content_type = part.content_type().unwrap_or("text/csv").to_owned();
        let bytes = part.bytes().await.map_err(IntoResponse::into_response)?;
        upload.files.push(FileRow {
            name: file_name.unwrap_or_else(|| format!("part {position}")),
            content_type,
            bytes: bytes.into(),
        });
    }
    if upload.files.is_empty() {
        let status = StatusCode::BAD_REQUEST;
        return Err(Problem::of_status(status, "the form has no file").into_response());
    }
    Ok(upload)
}
