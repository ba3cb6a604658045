//! What a file format is.

use std::borrow::Cow;

use super::encoding;
use super::fault::Fault;
use super::given::Given;
use super::part::Part;
use super::sight::Sight;

/// The content of a file, as bytes and, where it is one, as text.
pub(super) struct Content<'a> {
    pub(super) bytes: &'a [u8],
    text: Result<Cow<'a, str>, Fault>,
    /// How the text was decoded, if it is not UTF-8.
    pub(super) encoding: Option<String>,
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
    /// Its name, in words.
    pub(super) name: &'static str,
    /// Whether a file looks like it.
    pub(super) is: fn(&Content<'_>) -> bool,
    /// Reads a file that looks like it.
    pub(super) read: fn(&Content<'_>, &Given) -> Result<Part, Fault>,
    /// The table of such a file, readable or not; `None` for a format whose columns need no names,
    /// and where no table is found.
    pub(super) see: fn(&Content<'_>, &Given) -> Option<Sight>,
}
