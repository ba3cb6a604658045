//! Errors in an upload.

use super::columns::Column;
use super::lack::Lack;

/// Most characters of the name of a column in an error: a file may have a name as long as itself.
const MOST_OF_COLUMN: usize = 300;

/// Most characters of a reason.
const MOST_OF_REASON: usize = 2000;

/// A text whose middle is left out where it is longer than `most` characters.
fn shortened(text: String, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text;
    }
    let begin: String = text.chars().take(most / 2).collect();
    let end: String = text.chars().skip(count - most / 2 + 1).collect();
    format!("{begin}…{end}")
}

/// An error in an upload: where it is, and what is wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}{}: {reason}", line.map(|n| format!(", line {n}")).unwrap_or_default(),
    column.as_ref().map(|c| format!(", column {c}")).unwrap_or_default())]
pub struct ParseError {
    /// Name of the file.
    pub file: String,
    /// Line, counted from 1, if one can be named.
    pub line: Option<u64>,
    /// Name of the column (or JSON path, or metadata key), if one can be named.
    pub column: Option<String>,
    /// What is wrong, and what would be right.
    pub reason: String,
    /// What may be given beside the file to have it read.
    pub lacks: Vec<Lack>,
}

/// A [`ParseError`] without the file name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    line: Option<u64>,
    column: Option<String>,
    reason: String,
    lacks: Vec<Lack>,
}

impl Fault {
    pub(super) fn new(reason: impl Into<String>) -> Self {
        Self { line: None, column: None, reason: reason.into(), lacks: Vec::new() }
    }

    pub(super) fn at_line(mut self, line: Option<u64>) -> Self {
        self.line = line;
        self
    }

    /// The fault with more said.
    pub(super) fn and(mut self, more: &str) -> Self {
        self.reason.push_str(more);
        self
    }

    /// The fault with what would mend it if it were given.
    pub(super) fn lacking(mut self, lack: Lack) -> Self {
        self.lacks.push(lack);
        self
    }

    pub(super) fn in_column(mut self, column: impl Into<String>) -> Self {
        self.column = Some(column.into());
        self
    }

    /// The fault with the name that the file has for its column.
    pub(super) fn with_names_of_file(mut self, written: &[(Column, String)]) -> Self {
        let named =
            written.iter().find(|(column, _)| self.column.as_deref() == Some(column.name()));
        if let Some((column, written)) = named
            && !written.is_empty()
            && !written.eq_ignore_ascii_case(column.name())
        {
            self.column = Some(written.clone());
        }
        self
    }

    /// The fault with the sheet of a workbook that it is in.
    pub(super) fn in_sheet(self, sheet: &str) -> Self {
        self.and(&format!(" (in the sheet `{sheet}`)"))
    }

    pub(super) fn in_file(self, file: &str) -> ParseError {
        ParseError {
            file: file.to_owned(),
            line: self.line,
            column: self.column.map(|column| shortened(column, MOST_OF_COLUMN)),
            reason: shortened(self.reason, MOST_OF_REASON),
            lacks: self.lacks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_not_as_long_as_what_is_wrong() {
        let fault = Fault::new(format!("`{}` is unknown", "é".repeat(10_000)));
        let error = fault.in_column("a".repeat(500)).in_file("x");
        assert_eq!(error.reason.chars().count(), MOST_OF_REASON);
        assert!(error.reason.starts_with("`éé") && error.reason.ends_with("é` is unknown"));
        assert_eq!(error.column.map(|column| column.chars().count()), Some(MOST_OF_COLUMN));
        assert_eq!(Fault::new("short").in_file("x").reason, "short");
    }
}
