//! The formats that files may have: one file and one line each.

use std::borrow::Cow;

use super::fault::Fault;
use super::given::Given;
use super::part::Part;
use super::{delimited, encoding, json, sysid, twincat_scope, universal, xlsx};

/// The content of a file, as bytes and, where it is one, as text.
pub(super) struct Content<'a> {
    pub(super) bytes: &'a [u8],
    text: Result<Cow<'a, str>, Fault>,
    /// How the text was decoded, if it is not UTF-8.
    encoding: Option<String>,
}

impl<'a> Content<'a> {
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        match encoding::decode(bytes) {
            Ok((text, encoding)) => Self { bytes, text: Ok(text), encoding },
            Err(fault) => Self { bytes, text: Err(fault), encoding: None },
        }
    }

    /// The text.
    ///
    /// # Errors
    /// If the bytes are no text.
    pub(super) fn text(&self) -> Result<&str, Fault> {
        match &self.text {
            Ok(text) => Ok(text),
            Err(fault) => Err(fault.clone()),
        }
    }

    /// Whether the file is text that begins with one of these, blanks aside.
    pub(super) fn begins_with(&self, beginnings: &[&str]) -> bool {
        let text = self.text.as_ref().map(|text| text.trim_start()).unwrap_or_default();
        beginnings.iter().any(|beginning| text.starts_with(beginning))
    }
}

/// One file format.
pub(super) struct Format {
    /// Whether a file looks like it.
    pub(super) is: fn(&Content<'_>) -> bool,
    /// Reads a file that looks like it.
    pub(super) read: fn(&Content<'_>, &Given) -> Result<Part, Fault>,
}

/// All formats. The first that a file looks like reads it; the last reads whatever is left.
const FORMATS: &[Format] = &[
    xlsx::FORMAT,
    universal::FORMAT,
    twincat_scope::FORMAT,
    sysid::FORMAT,
    json::FORMAT,
    delimited::FORMAT,
];

/// Reads a file.
pub(super) fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    let content = Content::of(bytes);
    let format = FORMATS.iter().find(|format| (format.is)(&content)).unwrap_or(&delimited::FORMAT);
    let mut part = (format.read)(&content, given)?;
    part.notes.splice(0..0, content.encoding);
    Ok(part)
}
