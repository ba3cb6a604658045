//! Everything that a store keeps as one file that no engine is needed for: a backup, and the way from
//! one engine to the other.
//!
//! The file is packed with gzip. Unpacked it is lines of JSON: the first says what it is; then each
//! table has a line with its name and columns, and each row one with its values. Bytes follow the
//! line of their row as they are. The last line counts the rows and has the SHA-256 of all before it,
//! so that a file that is cut off or damaged is never taken for a whole one.

mod cell;
mod error;
mod reader;
mod tables;
#[cfg(test)]
mod tests;
mod writer;

use std::fmt;

use async_trait::async_trait;
use sha2::{Digest as _, Sha256};

pub(super) use cell::{Cell, cells};
pub use error::BackupError;
pub use reader::Reader;
#[cfg(test)]
pub(super) use tables::Kind;
pub(super) use tables::{Column, TABLES, Table};
pub use writer::Writer;

/// What the first line says, and the version of the format.
const FORMAT: (&str, u64) = ("servoscope_backup", 1);

/// A table of a backup with the columns that it has there.
#[derive(Debug, Clone)]
pub struct Section {
    table: &'static Table,
    columns: Vec<&'static Column>,
}

impl Section {
    /// Its name.
    pub(super) fn name(&self) -> &'static str {
        self.table.name
    }

    /// Names of its columns.
    pub(super) fn columns(&self) -> impl Iterator<Item = &'static str> {
        self.columns.iter().map(|column| column.name)
    }
}

/// The checksum as the last line of a backup has it.
fn checksum(of: &Sha256) -> String {
    of.clone().finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Rows of each table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rows(Vec<(&'static str, u64)>);

impl Rows {
    fn begin(&mut self, table: &'static Table) {
        self.0.push((table.name, 0));
    }

    fn count(&mut self) {
        if let Some((_, count)) = self.0.last_mut() {
            *count += 1;
        }
    }

    fn all(&self) -> u64 {
        self.0.iter().map(|(_, count)| count).sum()
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let there = self.0.iter().filter(|(_, count)| *count > 0);
        let named: Vec<_> = there.map(|(name, count)| format!("{name} {count}")).collect();
        match named.as_slice() {
            [] => formatter.write_str("nothing"),
            named => write!(formatter, "{}", named.join(", ")),
        }
    }
}

/// What an engine does for backups.
#[async_trait]
pub trait Portable {
    /// Writes everything, as it is at one moment, while others go on.
    async fn back_up(&self, into: &mut Writer<'_>) -> Result<(), BackupError>;

    /// Takes everything from a backup: all of it, or nothing where anything fails. Only an empty
    /// store does so. Jobs that ran are queued again as if they had been handed back.
    async fn restore(&self, from: &mut Reader<'_>) -> Result<(), BackupError>;
}
