//! How a backup is written.

use std::fmt;
use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use super::{BackupError, Cell, FORMAT, Rows, Table, checksum};

/// Writes a backup, row by row.
pub struct Writer<'w> {
    packed: GzEncoder<&'w mut (dyn Write + Send)>,
    digest: Sha256,
    rows: Rows,
}

impl fmt::Debug for Writer<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Writer").field("rows", &self.rows).finish_non_exhaustive()
    }
}

impl<'w> Writer<'w> {
    /// Begins a backup.
    ///
    /// # Errors
    /// [`BackupError::File`] where it cannot be written, as for the others.
    pub fn new(file: &'w mut (dyn Write + Send)) -> Result<Self, BackupError> {
        let packed = GzEncoder::new(file, Compression::fast());
        let mut writer = Self { packed, digest: Sha256::new(), rows: Rows::default() };
        let (name, version) = FORMAT;
        writer.line(&json!({name: version}))?;
        Ok(writer)
    }

    /// Begins a table.
    pub(in crate::store) fn begin(&mut self, table: &'static Table) -> Result<(), BackupError> {
        self.rows.begin(table);
        let columns: Vec<&str> = table.columns.iter().map(|column| column.name).collect();
        self.line(&json!({"table": table.name, "columns": columns}))
    }

    /// Writes a row of the table that was begun last.
    pub(in crate::store) fn row(&mut self, cells: &[Cell]) -> Result<(), BackupError> {
        self.rows.count();
        self.line(&cells.iter().map(Cell::to_json).collect())?;
        for cell in cells {
            if let Cell::Bytes(bytes) = cell {
                self.write(bytes)?;
                self.write(b"\n")?;
            }
        }
        Ok(())
    }

    /// Ends the backup, and says what is in it.
    ///
    /// # Errors
    /// [`BackupError::File`]
    pub fn finish(mut self) -> Result<Rows, BackupError> {
        let sha256 = checksum(&self.digest);
        self.line(&json!({"rows": self.rows.all(), "sha256": sha256}))?;
        let file = self.packed.finish().map_err(BackupError::File)?;
        file.flush().map_err(BackupError::File)?;
        Ok(self.rows)
    }

    fn line(&mut self, value: &Value) -> Result<(), BackupError> {
        self.write(format!("{value}\n").as_bytes())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), BackupError> {
        self.digest.update(bytes);
        self.packed.write_all(bytes).map_err(BackupError::File)
    }
}
