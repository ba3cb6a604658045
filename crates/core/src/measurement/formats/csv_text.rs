//! Parses CSV with a preamble of `# key: value` lines into a [`Table`].

use super::columns::Column;
use super::fault::Fault;
use super::header::Header;
use super::limits::MAX_ROWS;
use super::table::{Place, Table};

/// A CSV file whose preamble and header have been read.
pub(super) struct CsvText<'a> {
    /// The metadata in the preamble.
    pub(super) header: Header,
    /// Remarks on unknown metadata keys.
    pub(super) notes: Vec<String>,
    names: Vec<String>,
    names_line: u64,
    records: csv::Reader<&'a [u8]>,
    lines: LineCounter<'a>,
}

impl<'a> CsvText<'a> {
    /// Reads the preamble and the header.
    pub(super) fn open(text: &'a str) -> Result<Self, Fault> {
        refuse_bare_returns(text)?;
        let (header, notes, rest, line) = preamble(text)?;
        let records = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(rest.as_bytes());
        let lines = LineCounter { bytes: rest.as_bytes(), at: 0, line };
        let mut file = Self { header, notes, names: Vec::new(), names_line: line, records, lines };
        let mut record = csv::StringRecord::new();
        let Some(names_line) = file.next(&mut record)? else {
            return Err(Fault::new("the file is empty: there is no header and no row"));
        };
        file.names_line = names_line;
        file.names = record.iter().map(|name| unquote(name).to_ascii_lowercase()).collect();
        if let Some(twice) = first_twice(&file.names) {
            return Err(file.fault_of_header("this column is named twice").in_column(twice));
        }
        Ok(file)
    }

    /// Whether the header names this column.
    pub(super) fn has(&self, column: Column) -> bool {
        self.names.iter().any(|name| name == column.name())
    }

    /// A fault at the line of the column names.
    pub(super) fn fault_of_header(&self, reason: impl Into<String>) -> Fault {
        let mut reason = reason.into();
        if self.names.len() == 1 && self.names[0].contains([';', '\t']) {
            reason.push_str(" (fields must be separated by commas)");
        }
        Fault::new(reason).at_line(Some(self.names_line))
    }

    /// Reads the columns of one format as numbers, and notes the names of all others.
    pub(super) fn table(
        mut self,
        format: &[Column],
    ) -> Result<(Table, Header, Vec<String>), Fault> {
        let mut columns = Vec::new();
        let mut fields = Vec::new();
        for (index, name) in self.names.iter().enumerate() {
            match Column::find(name, format) {
                Some(column) => {
                    columns.push(column);
                    fields.push(index);
                }
                None if name.is_empty() => {
                    self.notes.push(format!("column {} has no name and is not used", index + 1));
                }
                None => self.notes.push(format!("column {name} is unknown and not used")),
            }
        }
        let mut table = Table::new(columns, Some(Place::Line(self.names_line)));
        let mut record = csv::StringRecord::new();
        while let Some(line) = self.next(&mut record)? {
            if record.len() != self.names.len() {
                return Err(Fault::new(format!(
                    "the row has {} fields, the header {}",
                    record.len(),
                    self.names.len()
                ))
                .at_line(Some(line)));
            }
            if table.len() == MAX_ROWS {
                return Err(Fault::new(format!("more than {MAX_ROWS} rows")).at_line(Some(line)));
            }
            table.push(Place::Line(line), fields.iter().map(|field| number(&record[*field])))?;
        }
        if table.len() == 0 {
            return Err(self.fault_of_header("there is no row after the header"));
        }
        Ok((table, self.header, self.notes))
    }

    /// The next record that is neither blank nor a comment, and its line.
    fn next(&mut self, record: &mut csv::StringRecord) -> Result<Option<u64>, Fault> {
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

/// Metadata, remarks on it, the text that begins with the header, and the header's line number.
fn preamble(text: &str) -> Result<(Header, Vec<String>, &str, u64), Fault> {
    let mut header = Header::default();
    let mut notes = Vec::new();
    let mut rest = text;
    let mut number = 1;
    while !rest.is_empty() {
        let end = rest.find('\n').unwrap_or(rest.len());
        let line = rest[..end].trim();
        if !line.is_empty() && !line.starts_with('#') {
            break;
        }
        if let Some((key, value)) = line.trim_start_matches('#').split_once(':') {
            let key = key.trim();
            let known = header.set(Some(number), key, value.trim())?;
            // A free-text comment may contain a colon, but only a misspelled key is one word.
            if !known && !key.is_empty() && !key.contains(char::is_whitespace) {
                notes.push(format!("line {number}: metadata key {key} is unknown and not used"));
            }
        }
        rest = rest.get(end + 1..).unwrap_or("");
        number += 1;
    }
    Ok((header, notes, rest, number))
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

fn first_twice(names: &[String]) -> Option<&str> {
    let mut seen = std::collections::HashSet::new();
    names.iter().find(|name| !name.is_empty() && !seen.insert(name.as_str())).map(String::as_str)
}

/// Removes quotes around a field. The CSV reader keeps those that follow a space as part of the
/// field.
fn unquote(field: &str) -> &str {
    let inner = field.strip_prefix('"').and_then(|field| field.strip_suffix('"'));
    inner.unwrap_or(field).trim()
}

fn number(field: &str) -> Result<Option<f64>, String> {
    let field = unquote(field);
    if field.is_empty() {
        return Ok(None);
    }
    field.parse().map(Some).map_err(|_| {
        let shown: String = field.chars().take(40).collect();
        format!("`{shown}` is not a number")
    })
}

#[cfg(test)]
mod tests {
    use super::super::columns::HARMONIC_TABLE;
    use super::*;

    fn table(text: &str) -> Result<(Table, Header, Vec<String>), Fault> {
        CsvText::open(text)?.table(HARMONIC_TABLE)
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
