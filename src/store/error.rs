//! Why the store could not do what was asked.

use sqlx::error::DatabaseError;

/// Primary result codes of SQLite, <https://www.sqlite.org/rescode.html>.
mod sqlite_code {
    pub(super) const READONLY: u32 = 8;
    pub(super) const FULL: u32 = 13;
}

/// The store could not do what was asked, and nothing of it was done.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// There is no room to write.
    #[error("no room: {0}")]
    Full(sqlx::Error),
    /// The database can be read and not written.
    #[error("read-only: {0}")]
    ReadOnly(sqlx::Error),
    /// The database refused or is out of reach.
    #[error("database: {0}")]
    Database(sqlx::Error),
    /// The tables could not be brought to the form this version needs.
    #[error("migrating the database: {0}")]
    Migration(#[from] sqlx::migrate::MigrateError),
    /// The folder of the database cannot be used.
    #[error("data directory: {0}")]
    Directory(#[from] std::io::Error),
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        match error.as_database_error().and_then(primary_code) {
            Some(sqlite_code::FULL) => Self::Full(error),
            Some(sqlite_code::READONLY) => Self::ReadOnly(error),
            _ => Self::Database(error),
        }
    }
}

/// The low byte of an extended result code says what kind of error it is.
fn primary_code(error: &dyn DatabaseError) -> Option<u32> {
    Some(error.code()?.parse::<u32>().ok()? & 0xff)
}
