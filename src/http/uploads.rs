//! Files that a request sends, and what it gives beside them.

use axum::body::Bytes;
use axum::extract::{FromRequest, Multipart, Request};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use crate::service::{MAX_NAME_BYTES, Upload};
use crate::store::FileRow;

use super::body;
use super::given::{AmplitudeName, DecimalName, LoopName, YesOrNo};
use super::measurements::media_type;
use super::problem::Problem;

/// Field of a form that names a stored mapping.
const MAPPING: &str = "mapping";

/// Query of an upload.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct UploadQuery {
    /// Name of the measurement and of its file in messages.
    name: Option<String>,
    /// Magnitude of the input at every frequency, for a table that has no column of it.
    magnitude: Option<String>,
    /// What the input is: `current A`.
    input: Option<String>,
    /// What the response is: `velocity rad/s`, `position mm`, `acceleration m/s²`.
    response: Option<String>,
    /// Whether the axis was measured in an `open` or a `closed` loop.
    #[param(inline, value_type = Option<LoopName>)]
    r#loop: Option<String>,
    /// What amplitudes are: `peak`, `rms` or `peak-to-peak`.
    #[param(inline, value_type = Option<AmplitudeName>)]
    amplitude: Option<String>,
    /// Period of a time record, seconds, or `none`.
    period_s: Option<String>,
    /// Decimal mark of the numbers in a text: `comma` or `point`.
    #[param(inline, value_type = Option<DecimalName>)]
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
    #[param(inline, value_type = Option<YesOrNo>)]
    inverted: Option<String>,
    /// Stored mapping that is used where the upload says nothing itself.
    mapping: Option<String>,
}

impl UploadQuery {
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
        Upload { name: self.name, given: given.collect(), mapping: self.mapping, files: Vec::new() }
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

/// The bytes of one file.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
pub(super) struct FileBody(#[expect(dead_code, reason = "it describes a body")] Vec<u8>);

/// Files and what is given beside them. Further fields are metadata: `machine`, `axis`,
/// `label.site` …
#[derive(ToSchema)]
#[expect(dead_code, reason = "it describes a body")]
pub(super) struct UploadForm {
    /// Files that together form one measurement.
    #[schema(value_type = Vec<String>, format = Binary)]
    file: Vec<Vec<u8>>,
    /// Magnitude of the input at every frequency, for a table that has no column of it.
    magnitude: Option<String>,
    /// What the input is: `current A`.
    input: Option<String>,
    /// What the response is: `velocity rad/s`, `position mm`, `acceleration m/s²`.
    response: Option<String>,
    /// Whether the axis was measured in an `open` or a `closed` loop.
    #[schema(inline, value_type = Option<LoopName>)]
    r#loop: Option<String>,
    /// What amplitudes are: `peak`, `rms` or `peak-to-peak`.
    #[schema(inline, value_type = Option<AmplitudeName>)]
    amplitude: Option<String>,
    /// Period of a time record, seconds, or `none`.
    period_s: Option<String>,
    /// Decimal mark of the numbers in a text: `comma` or `point`.
    #[schema(inline, value_type = Option<DecimalName>)]
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
    #[schema(inline, value_type = Option<YesOrNo>)]
    inverted: Option<String>,
    /// Stored mapping that is used where the upload says nothing itself.
    mapping: Option<String>,
}

/// The upload that a request makes.
pub(super) async fn read(query: UploadQuery, request: Request) -> Result<Upload, Response> {
    let mut upload = query.upload();
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
    let suffix = format!(".{extension}");
    // A name may be as long as that of a file, which has this at its end.
    let fits = |name: &&str| name.len() + suffix.len() <= MAX_NAME_BYTES;
    let stem = upload.name.as_deref().filter(fits).unwrap_or("upload");
    let name = if stem.ends_with(&suffix) { stem.to_owned() } else { format!("{stem}{suffix}") };
    upload.files.push(FileRow { name, content_type, bytes: bytes.into() });
    Ok(upload)
}

/// The parts of a form: files, and fields of metadata without a file name.
async fn form(mut upload: Upload, request: Request) -> Result<Upload, Response> {
    let mut parts =
        Multipart::from_request(request, &()).await.map_err(IntoResponse::into_response)?;
    while let Some(part) = parts.next_field().await.map_err(IntoResponse::into_response)? {
        let is_field = |name: &&str| *name == MAPPING || Upload::can_give(name);
        let field = part.name().filter(|name| part.file_name().is_none() && is_field(name));
        if let Some(key) = field.map(str::to_owned) {
            let value = part.text().await.map_err(IntoResponse::into_response)?;
            match key.as_str() {
                MAPPING => upload.mapping = Some(value),
                _ => drop(upload.given.insert(key, value)),
            }
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
        return Err(
            Problem::of_status(status, "the form has no file; add at least one").into_response()
        );
    }
    Ok(upload)
}
