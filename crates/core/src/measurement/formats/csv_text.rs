//! Parses delimited text with a preamble of `# key: value` lines into a table.

mod line_counter;
mod named_table;

use csv::StringRecord;

use super::delimiter::{Delimiter, unquote};
use super::fault::Fault;
use super::given::Given;
use super::header::Header;
use super::limits::{MAX_COLUMNS, MAX_LINE};
use super::preamble::{self, Preamble};
use line_counter::LineCounter;
pub(super) use named_table::NamedTable;

/// A text whose preamble and column names have been read.
pub(super) struct CsvText<'a> {
    /// The metadata in the preamble.
    pub(super) header: Header,
    /// Remarks on the preamble and on how the text is read.
    pub(super) notes: Vec<String>,
    /// Whether the line of the column names was found, or the first row where they are given.
    pub(super) found: bool,
    /// Whether the text stands for the cells of a sheet, whose delimiter and decimal mark are none
    /// of the file.
    of_cells: bool,
    comments: Vec<(String, String)>,
    names: Vec<String>,
    names_line: u64,
    delimiter: Delimiter,
    records: csv::Reader<&'a [u8]>,
    lines: LineCounter<'a>,
}

impl<'a> CsvText<'a> {
    /// Reads the preamble and the header.
    pub(super) fn open(text: &'a str, given: &Given) -> Result<Self, Fault> {
        refuse_bare_returns(text)?;
        refuse_long_lines(text)?;
        Self::of(preamble::read(text, None, given)?, false)
    }

    /// Reads the preamble and the header of a text that stands for the cells of a sheet, with tabs
    /// between them.
    pub(super) fn open_cells(text: &'a str, given: &Given) -> Result<Self, Fault> {
        Self::of(preamble::read(text, Some(Delimiter::Tab), given)?, true)
    }

    fn of(preamble: Preamble<'a>, of_cells: bool) -> Result<Self, Fault> {
        let Preamble { header, notes, delimiter, rest, line, found, comments } = preamble;
        let records = delimiter.reader(rest.as_bytes());
        let lines = LineCounter { bytes: rest.as_bytes(), at: 0, line };
        let names = Vec::new();
        let names_line = line;
        let mut file = Self {
            header,
            notes,
            found,
            of_cells,
            comments,
            names,
            names_line,
            delimiter,
            records,
            lines,
        };
        if let Some(names) = &file.header.column_names {
            file.names = names.clone();
            return Ok(file);
        }
        let mut record = StringRecord::new();
        let Some(names_line) = file.next(&mut record)? else {
            return Err(Fault::new("the file is empty: there is no header and no row"));
        };
        file.names_line = names_line;
        if record.len() > MAX_COLUMNS {
            return Err(file.fault_of_header(format!("more than {MAX_COLUMNS} columns")));
        }
        file.names = record.iter().map(|name| unquote(name).to_owned()).collect();
        Ok(file)
    }

    /// A fault at the line of the column names.
    fn fault_of_header(&self, reason: impl Into<String>) -> Fault {
        Fault::new(reason).at_line(Some(self.names_line))
    }

    /// The next record that is neither blank nor a comment, and its line.
    fn next(&mut self, record: &mut StringRecord) -> Result<Option<u64>, Fault> {
        loop {
            let more = self.records.read_record(record).map_err(|error| {
                Fault::new(format!("the text is not CSV: {error}"))
                    .at_line(error.position().map(|position| position.line()))
            })?;
            if !more {
                return Ok(None);
            }
            let start = record.position().map_or(0, csv::Position::byte);
            let line = self.lines.line_of_record(start as usize);
            let blank = record.iter().all(str::is_empty);
            let comment = record.get(0).is_some_and(|field| field.starts_with('#'));
            if self.delimiter == Delimiter::Blanks {
                *record = record.iter().filter(|cell| !cell.is_empty()).collect();
            }
            if !blank && !comment {
                return Ok(Some(line));
            }
        }
    }
}

/// Refuses a carriage return without a line feed. The CSV reader takes it as the end of a row but
/// not of a comment, so a comment would swallow the rows after it.
fn refuse_bare_returns(text: &str) -> Result<(), Fault> {
    let bytes = text.as_bytes();
    let bare = |at: &usize| bytes[*at] == b'\r' && bytes.get(at + 1) != Some(&b'\n');
    let Some(at) = (0..bytes.len()).find(bare) else { return Ok(()) };
    let line = 1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count() as u64;
    Err(Fault::new("a carriage return without a line feed: lines end with LF or CRLF")
        .at_line(Some(line)))
}

/// Refuses a line that is longer than any table has, before its cells are counted.
fn refuse_long_lines(text: &str) -> Result<(), Fault> {
    let long = (1..).zip(text.split('\n')).find(|(_, line)| line.len() > MAX_LINE);
    let Some((number, _)) = long else { return Ok(()) };
    let reason = format!("the line has more than {MAX_LINE} bytes: each row has a line of its own");
    Err(Fault::new(reason).at_line(Some(number)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::formats::columns::Column;
    use crate::measurement::formats::table::Table;

    fn table(text: &str) -> Result<(Table, Header, Vec<String>), Fault> {
        let named = CsvText::open(text, &Given::default())?.table()?;
        Ok((named.table, named.header, named.notes))
    }

    #[test]
    fn blank_lines_and_comments_count_in_line_numbers() {
        for newline in ["\n", "\r\n"] {
            let text = "# axis: X\n\n# free text\nre,im\n\n1,2\n# a remark\n\n3,4\n5,6\n\n\n"
                .replace('\n', newline);
            let (table, header, _) = table(&text).unwrap();
            assert_eq!(header.metadata.axis.as_deref(), Some("X"));
            let lines: Vec<String> = table.rows().map(|row| row.name()).collect();
            assert_eq!(lines, ["line 6", "line 9", "line 10"], "{newline:?}");
        }
    }

    #[test]
    fn quoted_and_spaced_fields_are_numbers() {
        let (table, ..) = table(" \"re\" , im \n \"1.5\" ,  +2e0 \n\"3\",\"\"\n,,\n")
            .unwrap_or_else(|fault| panic!("{fault:?}"));
        assert_eq!(table.row(0).get(Column::Re), Some(1.5));
        assert_eq!(table.row(0).get(Column::Im), Some(2.0));
        assert_eq!(table.row(1).get(Column::Im), None);
        assert_eq!(table.len(), 2);
    }

    #[test]
    fn a_quoted_line_break_counts_as_a_line() {
        let (table, ..) = table("re,comment\n1,\"two\nlines\"\n2,x\n").unwrap();
        assert_eq!(table.row(1).name(), "line 4");
    }

    #[test]
    fn a_misspelled_key_is_noted_and_a_sentence_is_not() {
        let (_, _, notes) = table("# settle_period: 2\n# we saw: nothing\nre,foo\n1,2\n").unwrap();
        assert_eq!(notes.len(), 2);
        assert!(notes[0].contains("settle_period") && notes[1].contains("foo"));
    }
}
