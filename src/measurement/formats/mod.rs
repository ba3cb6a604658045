//! File formats: bytes in, a [`Measurement`] out, or where and why not.
//!
//! Adding a format is one file here and one line in [`read`].

use super::Measurement;

/// One uploaded file.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Name to use in messages.
    pub name: &'a str,
    /// Content.
    pub bytes: &'a [u8],
}

/// Where an upload is wrong, and what is wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}{}: {reason}", line.map(|n| format!(", line {n}")).unwrap_or_default(),
    column.as_ref().map(|c| format!(", column {c}")).unwrap_or_default())]
pub struct ParseError {
    /// Name of the file.
    pub file: String,
    /// Line, from 1, where one can be named.
    pub line: Option<u64>,
    /// Name of the column (or JSON path), where one can be named.
    pub column: Option<String>,
    /// What is wrong, and what would be right.
    pub reason: String,
}

/// Reads one or several files that together form one measurement.
///
/// # Errors
/// The first thing that is wrong; nothing is half-read.
pub fn read(sources: &[Source<'_>]) -> Result<Measurement, ParseError> {
    let file = sources.first().map_or("upload", |source| source.name).to_owned();
    Err(ParseError { file, line: None, column: None, reason: "not built yet".into() })
}
