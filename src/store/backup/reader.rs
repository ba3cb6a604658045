//! How a backup is read.

use std::fmt;
use std::io::{BufRead, BufReader, Read};

use flate2::bufread::MultiGzDecoder;
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use super::{BackupError, Cell, Column, FORMAT, Rows, Section, TABLES, checksum};

/// Bytes with which a packed file begins.
const PACKED: [u8; 2] = [0x1f, 0x8b];

/// Reads a backup, row by row.
pub struct Reader<'r> {
    unpacked: Box<dyn BufRead + Send + 'r>,
    digest: Sha256,
    section: Option<Section>,
    /// The line that begins the next table, or ends the backup.
    ahead: Option<Value>,
    rows: Rows,
}

impl fmt::Debug for Reader<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Reader").field("rows", &self.rows).finish_non_exhaustive()
    }
}

impl<'r> Reader<'r> {
    /// Begins to read a backup.
    ///
    /// # Errors
    /// Where the file is another one or cannot be read.
    pub fn new(file: impl Read + Send + 'r) -> Result<Self, BackupError> {
        let mut file = BufReader::new(file);
        if !file.fill_buf().map_err(BackupError::reading)?.starts_with(&PACKED) {
            return Err(BackupError::Foreign);
        }
        let mut reader = Self {
            unpacked: Box::new(BufReader::new(MultiGzDecoder::new(file))),
            digest: Sha256::new(),
            section: None,
            ahead: None,
            rows: Rows::default(),
        };
        let first = reader.line()?;
        let (name, version) = FORMAT;
        match first[name].as_u64() {
            None => Err(BackupError::Foreign),
            Some(other) if other != version => {
                Err(BackupError::Newer(format!("it has version {other} of the format")))
            }
            Some(_) => {
                reader.ahead = Some(reader.line()?);
                Ok(reader)
            }
        }
    }

    /// What was read.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The next table; `None` at the end of a backup that is whole.
    pub(in crate::store) fn section(&mut self) -> Result<Option<Section>, BackupError> {
        while self.row()?.is_some() {}
        let Some(line) = self.ahead.take() else { return Ok(None) };
        let Some(name) = line["table"].as_str() else {
            return self.end(&line).map(|()| None);
        };
        let newer = |what: &str| BackupError::Newer(format!("it has {what}"));
        let table = TABLES.iter().find(|table| table.name == name);
        let table = table.ok_or_else(|| newer(&format!("a table {name}")))?;
        let names = line["columns"].as_array().ok_or_else(|| damaged("a table without columns"))?;
        let column = |column: &Value| {
            let found = table.columns.iter().find(|one| Some(one.name) == column.as_str());
            found.ok_or_else(|| newer(&format!("a column {column} of {name}")))
        };
        let columns = names.iter().map(column).collect::<Result<_, _>>()?;
        self.rows.begin(table);
        let section = Section { table, columns };
        self.section = Some(section.clone());
        Ok(Some(section))
    }

    /// The next row of the table that was begun last; `None` after the last one.
    pub(in crate::store) fn row(&mut self) -> Result<Option<Vec<Cell>>, BackupError> {
        let Some(section) = self.section.take() else { return Ok(None) };
        let cells = match self.line()? {
            Value::Array(cells) => cells,
            line => {
                self.ahead = Some(line);
                return Ok(None);
            }
        };
        if cells.len() != section.columns.len() {
            return Err(damaged("a row that does not fit its table"));
        }
        let pairs = cells.into_iter().zip(&section.columns);
        let row =
            pairs.map(|(value, column)| self.cell(value, column)).collect::<Result<_, _>>()?;
        self.rows.count();
        self.section = Some(section);
        Ok(Some(row))
    }

    fn cell(&mut self, value: Value, column: &Column) -> Result<Cell, BackupError> {
        if let Some(count) = value["bytes"].as_u64() {
            return self.bytes(count).map(Cell::Bytes);
        }
        let cell = Cell::from_json(value, column);
        cell.ok_or_else(|| damaged(&format!("a value that is none of {}", column.name)))
    }

    /// So many bytes and the end of their line.
    fn bytes(&mut self, count: u64) -> Result<Vec<u8>, BackupError> {
        let mut bytes = Vec::new();
        let taken = (&mut self.unpacked).take(count.saturating_add(1)).read_to_end(&mut bytes);
        taken.map_err(BackupError::reading)?;
        self.digest.update(&bytes);
        match bytes.pop() {
            Some(b'\n') if bytes.len() as u64 == count => Ok(bytes),
            _ => Err(damaged("bytes are missing")),
        }
    }

    /// Compares what was read with what the last line says.
    fn end(&mut self, last: &Value) -> Result<(), BackupError> {
        if last["rows"].as_u64() != Some(self.rows.all()) {
            return Err(damaged("rows are missing"));
        }
        if last["sha256"].as_str() != Some(&checksum(&self.digest)) {
            return Err(damaged("its checksum is another"));
        }
        let beyond = self.unpacked.fill_buf().map_err(BackupError::reading)?;
        if beyond.is_empty() { Ok(()) } else { Err(damaged("something follows its end")) }
    }

    fn line(&mut self) -> Result<Value, BackupError> {
        let mut line = Vec::new();
        self.unpacked.read_until(b'\n', &mut line).map_err(BackupError::reading)?;
        if line.last() != Some(&b'\n') {
            return Err(damaged("it ends too early"));
        }
        let value: Value =
            serde_json::from_slice(&line).map_err(|error| damaged(&error.to_string()))?;
        // The last line states the sum of those before it.
        if value.get("sha256").is_none() {
            self.digest.update(&line);
        }
        Ok(value)
    }
}

fn damaged(how: &str) -> BackupError {
    BackupError::Damaged(how.into())
}
