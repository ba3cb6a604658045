//! The formats that files may have: one file and one line each.

use super::fault::Fault;
use super::format::{Content, Format};
use super::given::Given;
use super::part::Part;
use super::{delimited, json, matlab, sysid, tdms, twincat_scope, universal, xlsx};

/// All formats. The first that a file looks like reads it; the last reads whatever is left.
const FORMATS: &[Format] = &[
    xlsx::FORMAT,
    universal::FORMAT,
    matlab::FORMAT,
    tdms::FORMAT,
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
