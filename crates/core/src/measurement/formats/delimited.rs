//! Tables in delimited text: harmonic tables and time records.

use super::csv_text::{CsvText, NamedTable};
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::part::Part;
use super::sight::Sight;
use super::{harmonic_table, time_record};

/// Any text that is nothing else.
pub(super) const FORMAT: Format = Format {
    name: "text in columns",
    is: |_| true,
    read: |content, given| read(content.text()?, given),
    see: |content, given| Sight::of_text(content.text().ok()?, None, given),
};

fn read(text: &str, given: &Given) -> Result<Part, Fault> {
    part(CsvText::open(text, given)?.table()?)
}

/// The content of a table with named columns.
pub(super) fn part(named: NamedTable) -> Result<Part, Fault> {
    let NamedTable { table, header, notes, timed, written } = named;
    let part = match timed {
        true => time_record::read(&table, header, notes),
        false => harmonic_table::read(&table, header, notes),
    };
    part.map_err(|fault| fault.with_names_of_file(&written))
}
