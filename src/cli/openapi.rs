//! `servoscope openapi`

use std::io::Write;

use crate::http;

use super::Failure;

/// Prints the document that is kept as `openapi.yaml`.
pub(super) fn run() -> Result<(), Failure> {
    let document = http::openapi().to_yaml().map_err(Failure::other)?;
    std::io::stdout().write_all(document.as_bytes()).map_err(Failure::other)
}
