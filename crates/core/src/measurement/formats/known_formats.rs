//! The formats that files may have: one file and one line each.

use super::fault::Fault;
use super::format::{Content, Format};
use super::given::Given;
use super::part::Part;
use super::sight::Sight;
use super::{bam, delimited, json, matlab, sysid, tdms, twincat_scope, universal, xlsx};

/// All formats. The first that a file looks like reads it; the last reads whatever is left.
const FORMATS: &[Format] = &[
    xlsx::FORMAT,
    universal::FORMAT,
    matlab::FORMAT,
    tdms::FORMAT,
    twincat_scope::FORMAT,
    sysid::FORMAT,
    bam::FORMAT,
    json::FORMAT,
    delimited::FORMAT,
];

/// The format of a file.
fn of(content: &Content<'_>) -> &'static Format {
    FORMATS.iter().find(|format| (format.is)(content)).unwrap_or(&delimited::FORMAT)
}

/// Looks at a file: the name of its format, how its text is decoded, and its table.
pub(super) fn see(bytes: &[u8], given: &Given) -> (&'static str, Option<String>, Option<Sight>) {
    let content = Content::of(bytes);
    let format = of(&content);
    let sight = (format.see)(&content, given);
    (format.name, content.encoding, sight)
}

/// Reads a file.
pub(super) fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    let content = Content::of(bytes);
    let format = of(&content);
    let mut part = (format.read)(&content, given)?;
    part.notes.splice(0..0, content.encoding);
    Ok(part)
}
