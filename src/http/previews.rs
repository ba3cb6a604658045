//! `/v1/preview`: what would be understood of an upload.

use std::collections::BTreeMap;

use axum::extract::Request;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Serialize;
use utoipa::ToSchema;

use crate::service::{
    ColumnLook, FileLook, Lack, Measured, ParseError, Preview, QUANTITIES, QuantityChoice, Service,
    TableLook,
};

use super::problem::Problem;
use super::query::Query;
use super::uploads::{self, FileBody, UploadForm, UploadQuery};
use super::views::SignalView;

/// What would be understood of an upload.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Preview)]
pub(super) struct PreviewView {
    /// One for each file.
    files: Vec<FilePreview>,
    /// What would be stored; null where the upload would be refused.
    measurement: Option<MeasurementPreview>,
    /// Why the upload would be refused; null where it would not.
    refusal: Option<Refusal>,
    /// All that is given: by the request, and by the mapping where the request says nothing.
    given: BTreeMap<String, String>,
    /// The stored mapping that would be used; null: none.
    mapping: Option<String>,
    /// The same for uploads of the same formats, column names and units; of a text without column
    /// names, of the same delimiter, number of columns and decimal mark. Null where neither is known.
    /// A mapping stored with it is used for such files by itself, and a note says so.
    layout: Option<String>,
    /// What a column may be: the choice for `column_names`.
    quantities: Vec<QuantityView>,
}

/// What is seen of one file.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct FilePreview {
    /// Its name.
    name: String,
    /// Its format, in words.
    format: &'static str,
    /// How the text is decoded; null for UTF-8.
    encoding: Option<String>,
    /// Its table; null for a format whose columns need no names, and where no table is found.
    table: Option<TablePreview>,
}

/// What is seen of a table.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct TablePreview {
    /// What separates its columns: `commas`, `semicolons`, `tabs` or `blanks`; null: it is no text.
    delimiter: Option<&'static str>,
    /// Decimal mark: `comma` or `point`; null where no number has one, or it is not clear.
    decimal: Option<&'static str>,
    /// Lines above the column names, at most 20.
    preamble: Vec<String>,
    /// Line of the column names, or of the first row where there are none, from 1; null: it is no
    /// text.
    line: Option<u64>,
    /// Its columns.
    columns: Vec<ColumnPreview>,
    /// Its first rows, at most 20, cell by cell as they are written.
    rows: Vec<Vec<String>>,
    /// Sheets of a workbook that have a table.
    sheets: Vec<String>,
}

/// What is seen of a column.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ColumnPreview {
    /// Its name as the file has it; empty where it has none.
    name: String,
    /// Key of the quantity that it is taken for; null where that is not known.
    quantity: Option<&'static str>,
    /// Its unit; empty where it is not said.
    unit: String,
    /// Name of the column that it is used as, such as `time_s`; null where it is not used.
    used_as: Option<&'static str>,
}

/// What would be stored.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct MeasurementPreview {
    /// Number of experiments.
    experiments: i64,
    /// Highest harmonic of any experiment.
    highest_harmonic: i64,
    /// Smallest and largest magnitude, input units.
    magnitude_range: [f64; 2],
    /// Lowest and highest fundamental, rad/s.
    omega_range_rad_s: [f64; 2],
    /// The input.
    input: Option<SignalView>,
    /// The response.
    response: Option<SignalView>,
    /// `velocity`, `position` or `acceleration`.
    response_kind: Option<String>,
    /// Remarks of the reader.
    notes: Vec<String>,
}

/// Why an upload would be refused.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Refusal {
    /// In words.
    detail: String,
    /// File that is wrong.
    file: String,
    /// Line that is wrong, from 1.
    line: Option<u64>,
    /// Column that is wrong.
    column: Option<String>,
    /// What to give so that the file can be read; empty where the file itself is wrong.
    missing: Vec<Missing>,
}

/// What a file lacks.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Missing {
    /// Name of the parameter, the field or the line of metadata.
    key: &'static str,
    /// A value that it may have.
    example: String,
    /// How to give it, in words.
    how: String,
}

/// A quantity that a column may hold.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = QuantityChoice)]
pub(super) struct QuantityView {
    /// Its key.
    key: &'static str,
    /// What it is, in words.
    title: &'static str,
    /// Its name in `column_names`; a unit follows in brackets.
    name: &'static str,
    /// Usual units; empty if it has none to be said.
    units: &'static [&'static str],
}

impl From<Preview> for PreviewView {
    fn from(Preview { look, given, mapping, read }: Preview) -> Self {
        let (measurement, refusal) = match read {
            Ok(measured) => (Some(measured.into()), None),
            Err(error) => (None, Some(error.into())),
        };
        Self {
            files: look.files.into_iter().map(Into::into).collect(),
            measurement,
            refusal,
            given,
            mapping,
            layout: look.layout,
            quantities: QUANTITIES.iter().map(Into::into).collect(),
        }
    }
}

impl From<FileLook> for FilePreview {
    fn from(FileLook { name, format, encoding, table }: FileLook) -> Self {
        Self { name, format, encoding, table: table.map(Into::into) }
    }
}

impl From<TableLook> for TablePreview {
    fn from(look: TableLook) -> Self {
        let TableLook { delimiter, decimal, preamble, line, columns, rows, sheets } = look;
        let columns = columns.into_iter().map(Into::into).collect();
        Self { delimiter, decimal, preamble, line, columns, rows, sheets }
    }
}

impl From<ColumnLook> for ColumnPreview {
    fn from(ColumnLook { name, quantity, unit, used_as }: ColumnLook) -> Self {
        Self { name, quantity, unit, used_as }
    }
}

impl From<Measured> for MeasurementPreview {
    fn from(Measured { row, quantities, notes, .. }: Measured) -> Self {
        let (input, response, response_kind, _) = SignalView::both(quantities);
        Self {
            experiments: row.experiments,
            highest_harmonic: row.highest_harmonic,
            magnitude_range: [row.magnitude_min, row.magnitude_max],
            omega_range_rad_s: [row.omega_min_rad_s, row.omega_max_rad_s],
            input,
            response,
            response_kind,
            notes,
        }
    }
}

impl From<ParseError> for Refusal {
    fn from(error: ParseError) -> Self {
        let detail = error.to_string();
        let ParseError { file, line, column, lacks, .. } = error;
        let missing =
            |lack: Lack| Missing { how: lack.to_string(), key: lack.key, example: lack.example };
        Self { detail, file, line, column, missing: lacks.into_iter().map(missing).collect() }
    }
}

impl From<&QuantityChoice> for QuantityView {
    fn from(&QuantityChoice { key, title, name, units }: &QuantityChoice) -> Self {
        Self { key, title, name, units }
    }
}

/// Says what would be understood of an upload, and stores nothing.
///
/// It takes what an upload takes. A file that would be refused is no error here: the answer says
/// why, what is known of its columns, and what to give.
#[utoipa::path(
    post, path = "/v1/preview", tag = "measurements", operation_id = "preview_measurement",
    params(UploadQuery),
    request_body(
        description = "As for an upload",
        content(
            (FileBody = "text/csv"), (FileBody = "application/json"), (FileBody = "text/plain"),
            (FileBody = "text/tab-separated-values"),
            (FileBody = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"),
            (FileBody = "application/octet-stream"), (UploadForm = "multipart/form-data"),
        )
    ),
    responses(
        (status = 200, body = PreviewView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn preview(
    Extension(service): Extension<Service>,
    Query(query): Query<UploadQuery>,
    request: Request,
) -> Result<Json<PreviewView>, Response> {
    let upload = uploads::read(query, request).await?;
    let preview = service.preview(upload).await;
    let preview = preview.map_err(|error| Box::<Problem>::from(error).into_response())?;
    Ok(Json(preview.into()))
}
