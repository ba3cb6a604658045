//! Rows as tables.

use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::service::harmless;

use super::problem::Problem;

/// Rows as CSV.
pub(super) fn csv(columns: &[&str], rows: &[impl Serialize]) -> Result<Response, Box<Problem>> {
    let internal = |error: &dyn std::fmt::Display| {
        let status = StatusCode::INTERNAL_SERVER_ERROR;
        Problem::internal(status, "this answer cannot be written as CSV; ask for it as JSON", error)
    };
    // The header by hand: there may be no row to take it from.
    let plain = || csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    let mut serialised = plain();
    for row in rows {
        serialised.serialize(row).map_err(|error| internal(&error))?;
    }
    let serialised = serialised.into_inner().map_err(|error| internal(&error))?;
    let mut table = plain();
    table.write_record(columns).map_err(|error| internal(&error))?;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&serialised[..]);
    for row in reader.records() {
        let row = row.map_err(|error| internal(&error))?;
        let cells = row.iter().map(|cell| harmless(cell).into_owned());
        table.write_record(cells).map_err(|error| internal(&error))?;
    }
    let bytes = table.into_inner().map_err(|error| internal(&error))?;
    Ok(([(header::CONTENT_TYPE, "text/csv; charset=utf-8")], bytes).into_response())
}
