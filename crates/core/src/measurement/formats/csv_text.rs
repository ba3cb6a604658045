//! Parses delimited text with a preamble of `# key: value` lines into a [`Table`].

use csv::StringRecord;

use super::columns::Column;
use super::decimal::{Decimals, Mark, is_number};
use super::delimiter::{Delimiter, unquote};
use super::fault::Fault;
use super::given::Given;
use super::header::Header;
use super::instruments;
use super::lack;
use super::limits::{MAX_COLUMNS, MAX_LINE, MAX_ROWS};
use super::name::{self, Name};
use super::naming;
use super::preamble::{self, Preamble};
use super::table::{Place, Table};

const NO_KNOWN_COLUMN: &str = "the header has no known column: a time record needs \
    time_s,input,output, a harmonic table magnitude,omega_rad_s,harmonic,re,im";

/// Most columns without a name in an example of names.
const MAX_EXAMPLE: usize = 20;

/// A table, and what is known of its columns.
pub(super) struct NamedTable {
    pub(super) table: Table,
    pub(super) header: Header,
    pub(super) notes: Vec<String>,
    /// Whether it is a time record.
    pub(super) timed: bool,
    /// The names that the file has for the columns that are used.
    pub(super) written: Vec<(Column, String)>,
}

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

    /// Reads the columns that are known as numbers, and notes the names of all others.
    pub(super) fn table(mut self) -> Result<NamedTable, Fault> {
        let mut record = StringRecord::new();
        let mut next = self.next(&mut record)?;
        let units = next.is_some_and(|_| is_row_of_units(&record)).then(|| record.clone());
        if let (Some(units), Some(line)) = (&units, next) {
            self.notes.push(format!("line {line} is read as the units: {}", shown(units)));
            next = self.next(&mut record)?;
        }
        let written_names = self.names.clone();
        if let Some(instrument) = instruments::find(&self.names) {
            self.notes.push(format!("the file is of {}", instrument.name));
            self.names = (instrument.names)(&self.names, &self.comments, &mut self.header)
                .map_err(|fault| fault.at_line(Some(self.names_line)))?;
        }
        let unit = |field| units.as_ref().and_then(|units| units.get(field));
        let names = self.names.iter().enumerate();
        let names: Vec<Name> = names.map(|(field, name)| Name::of(name, unit(field))).collect();
        if !names.iter().any(Name::is_known) {
            let lack = lack::ask("column_names", example(names.len()));
            let reason = match self.names.iter().all(|name| is_number(name)) {
                true => format!("{} of numbers and no column names", columns(names.len())),
                false => NO_KNOWN_COLUMN.to_owned(),
            };
            return Err(self.fault_of_header(format!("{reason}; {lack}")).lacking(lack));
        }
        let line = self.names_line;
        let naming =
            naming::resolve(&names, &mut self.header).map_err(|fault| fault.at_line(Some(line)))?;
        let columns: Vec<Column> = naming.used.iter().map(|used| used.column).collect();
        let written = naming
            .used
            .iter()
            .map(|used| written_names.get(used.field).cloned().unwrap_or_default());
        let written: Vec<_> = columns.iter().copied().zip(written).collect();
        let mut table = Table::new(columns, Some(Place::Line(line)));
        let mut decimals = Decimals::new(self.header.decimal);
        while let Some(line) = next {
            self.check_length(&record, line)?;
            if table.len() == MAX_ROWS {
                return Err(Fault::new(format!("more than {MAX_ROWS} rows")).at_line(Some(line)));
            }
            let row = table.len();
            let cells = naming.used.iter().map(|used| {
                if used.field == naming::ROW_NUMBER {
                    return Ok(Some(used.convert(row as f64)));
                }
                let cell = unquote(record.get(used.field).unwrap_or_default());
                Ok(decimals.number(line, cell)?.map(|number| used.convert(number)))
            });
            table
                .push(Place::Line(line), cells)
                .map_err(|fault| fault.with_names_of_file(&written))?;
            next = self.next(&mut record)?;
        }
        if table.len() == 0 {
            return Err(self.fault_of_header("there is no row after the header"));
        }
        let mark = decimals.mark()?;
        let usual = self.delimiter == Delimiter::Comma && mark != Some(Mark::Comma);
        if !usual && !self.of_cells {
            self.notes.push(said(self.delimiter, mark));
        }
        self.notes.extend(naming.notes);
        let Self { header, notes, .. } = self;
        Ok(NamedTable { table, header, notes, timed: naming.timed, written })
    }

    /// Checks that a row has a cell for every column that has a name, and none beside them that is
    /// filled.
    fn check_length(&self, record: &StringRecord, line: u64) -> Result<(), Fault> {
        let named = |names: &[String]| names.iter().rposition(|name| !name.is_empty());
        let needed = named(&self.names).map_or(0, |last| last + 1);
        let filled = (1..).zip(record).filter(|(_, cell)| !unquote(cell).is_empty());
        let filled = filled.last().map_or(0, |(count, _)| count);
        if record.len() >= needed && filled <= self.names.len() {
            return Ok(());
        }
        let (cells, names) = (record.len(), self.names.len());
        let mut reason = format!("the row has {cells} fields, the header {names}");
        if self.delimiter == Delimiter::Comma && filled == 2 * names {
            reason.push_str(": where numbers have decimal commas, separate them by semicolons");
        }
        Err(Fault::new(reason).at_line(Some(line)))
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

/// Names of so many columns, as an example: a column that is not used has none.
fn example(count: usize) -> String {
    let known = ["Time (s)", "Current (A)", "Position (mm)"];
    let unused = std::iter::repeat_n("", count.saturating_sub(known.len()).min(MAX_EXAMPLE));
    known.into_iter().chain(unused).collect::<Vec<_>>().join("; ").trim_end().to_owned()
}

fn columns(count: usize) -> String {
    match count {
        1 => "the file has one column".to_owned(),
        count => format!("the file has columns 1 to {count}"),
    }
}

/// Whether a row below the names has their units: some cell is a unit, and none is a number.
fn is_row_of_units(record: &StringRecord) -> bool {
    let cells = || record.iter().map(unquote).filter(|cell| !cell.is_empty());
    // 1 is a unit, too, that of a ratio.
    cells().any(|cell| cell != "1" && name::is_unit(cell))
        && !cells().any(|cell| cell != "1" && is_number(cell))
}

fn shown(record: &StringRecord) -> String {
    record.iter().map(unquote).collect::<Vec<_>>().join(", ")
}

/// How a text is read that is not in the form of the contract.
fn said(delimiter: Delimiter, mark: Option<Mark>) -> String {
    let decimals = match mark {
        Some(Mark::Comma) => ", and numbers have a decimal comma",
        Some(Mark::Point) => ", and numbers have a decimal point",
        None => "",
    };
    format!("columns are separated by {}{decimals}", delimiter.name())
}

/// Finds the line number of a record from its byte offset.
///
/// The CSV reader's own line number is that of the first blank line or comment before the record,
/// and it falls behind in files with CRLF.
struct LineCounter<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl LineCounter<'_> {
    /// The line of the record that the reader began to search for at byte `start`.
    fn line_of_record(&mut self, start: usize) -> u64 {
        self.advance_to(start);
        while let Some(byte) = self.bytes.get(self.at) {
            match byte {
                b'\n' | b'\r' => self.advance_to(self.at + 1),
                b'#' => {
                    let rest = &self.bytes[self.at..];
                    let end = rest.iter().position(|byte| *byte == b'\n');
                    self.advance_to(self.at + end.unwrap_or(rest.len()));
                }
                _ => break,
            }
        }
        self.line
    }

    fn advance_to(&mut self, target: usize) {
        let target = target.min(self.bytes.len());
        let passed = &self.bytes[self.at.min(target)..target];
        self.line += passed.iter().filter(|byte| **byte == b'\n').count() as u64;
        self.at = self.at.max(target);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
