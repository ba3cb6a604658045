//! `servoscope openapi`

use crate::http;

use super::{Failure, terminal};

/// Prints the document that is kept as `openapi.yaml`.
pub(super) fn run() -> Result<(), Failure> {
    let document = http::openapi().to_yaml().map_err(Failure::other)?;
    terminal::print_raw(document.as_bytes())
}
