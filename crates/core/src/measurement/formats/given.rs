//! What an uploader states beside the files: settings and metadata that they lack.

use std::collections::BTreeMap;

use super::fault::{Fault, ParseError};
use super::header::Header;
use super::source::Source;

/// First line of the text that carries the statements.
const FIRST_LINE: &str = "# given with the upload";

/// Metadata that is given beside the files, for all of them: the flags of a command, or the query
/// and the form fields of a request.
///
/// It has the keys of the `# key: value` lines of a file. Where a file says something else, what is
/// given here holds, and a note says so. [`Given::text`] goes with the files as one more
/// [`Source`], so that whoever stores the files stores it too, and the digest of the measurement
/// covers it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Given {
    entries: BTreeMap<String, String>,
}

impl Given {
    /// Name of the source that carries what is given.
    pub const NAME: &str = "given with the upload";

    /// Whether a key is one of the metadata.
    pub fn knows(key: &str) -> bool {
        Header::has_exactly(key)
    }

    /// States a value.
    ///
    /// # Errors
    /// If the key is unknown, the value means nothing, or the key was given another value.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), ParseError> {
        let fault = |fault: Fault| fault.in_column(key).in_file(Self::NAME);
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        if !Header::has_exactly(key) || !Header::default().set(None, key, &value).map_err(fault)? {
            return Err(fault(Fault::new("there is no metadata of this name")));
        }
        match self.entries.insert(key.to_owned(), value.clone()) {
            Some(earlier) if earlier != value => {
                Err(fault(Fault::new(format!("given twice: `{earlier}` and `{value}`"))))
            }
            _ => Ok(()),
        }
    }

    /// Checks what is given together.
    ///
    /// # Errors
    /// If there are more labels than a measurement may have.
    pub fn check(&self) -> Result<(), ParseError> {
        let taken = Header::default().take(self, &mut Vec::new());
        taken.map_err(|fault| fault.in_file(Self::NAME))
    }

    /// The text to pass along with the files; `None` if nothing is given.
    pub fn text(&self) -> Option<String> {
        let lines = self.entries.iter().map(|(key, value)| format!("# {key}: {value}\n"));
        (!self.entries.is_empty()).then(|| format!("{FIRST_LINE}\n{}", lines.collect::<String>()))
    }

    /// What a source gives; `None` if it is a file and not the text of [`Given::text`].
    pub fn of(source: &Source<'_>) -> Option<Result<Self, ParseError>> {
        let text = std::str::from_utf8(source.bytes).ok()?.strip_prefix(FIRST_LINE)?;
        let mut given = Self::default();
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            let entry = line.strip_prefix('#').and_then(|line| line.split_once(':'));
            let set = match entry {
                Some((key, value)) => given.set(key.trim(), value),
                None => Err(Fault::new("the line is not `# key: value`").in_file(source.name)),
            };
            if let Err(error) = set {
                return Some(Err(error));
            }
        }
        Some(Ok(given))
    }

    /// A value, if it is given.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.entries.get(key).map(String::as_str)
    }

    /// The names of the columns, if they are given.
    pub(super) fn column_names(&self) -> Option<Vec<String>> {
        self.header().column_names
    }

    /// What is given, as metadata.
    pub(super) fn header(&self) -> Header {
        let mut header = Header::default();
        for (key, value) in &self.entries {
            // What means nothing was refused when it was set.
            let _ = header.set(None, key, value);
        }
        header
    }

    /// Keys and values.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_survives_as_text() {
        let mut given = Given::default();
        assert_eq!(given.text(), None);
        given.set("response", "position  mm").unwrap();
        given.set("decimal", "comma").unwrap();
        let text = given.text().unwrap();
        assert_eq!(text, "# given with the upload\n# decimal: comma\n# response: position mm\n");
        let source = Source { name: "x", bytes: text.as_bytes() };
        assert_eq!(Given::of(&source), Some(Ok(given)));
        assert_eq!(Given::of(&Source { name: "x", bytes: b"# axis: X\n" }), None);
    }

    #[test]
    fn a_value_that_means_nothing_is_refused_by_its_key() {
        let mut given = Given::default();
        for (key, value) in
            [("colour", "red"), ("Axis", "X"), ("response", "red"), ("decimal", "red")]
        {
            let error = given.set(key, value).unwrap_err();
            assert_eq!((error.file.as_str(), error.column.as_deref()), (Given::NAME, Some(key)));
        }
        given.set("axis", "X").unwrap();
        assert!(given.set("axis", "Y").unwrap_err().reason.contains("twice"));
    }
}
