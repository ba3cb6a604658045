//! Why the store could not do what was asked.

use sqlx::error::DatabaseError;
use sqlx::migrate::MigrateError;
use sqlx::postgres::PgDatabaseError;

/// Primary result codes of SQLite, <https://www.sqlite.org/rescode.html>.
mod sqlite_code {
    pub(super) const BUSY: u32 = 5;
    pub(super) const READONLY: u32 = 8;
    pub(super) const CORRUPT: u32 = 11;
    pub(super) const FULL: u32 = 13;
    pub(super) const TOO_BIG: u32 = 18;
    pub(super) const CONSTRAINT: u32 = 19;
    pub(super) const MISMATCH: u32 = 20;
    pub(super) const NOT_A_DATABASE: u32 = 26;
    /// What a trigger raises, an extended code.
    pub(super) const RAISED: u32 = 1811;
}

/// States of Postgres, <https://www.postgresql.org/docs/current/errcodes-appendix.html>.
mod postgres_code {
    pub(super) const DISK_FULL: &str = "53100";
    pub(super) const READ_ONLY: &str = "25006";
    pub(super) const NOT_IN_ENCODING: &str = "22021";
    pub(super) const UNTRANSLATABLE: &str = "22P05";
    /// Classes of states: a value that is out of range or malformed, one that a constraint forbids, and
    /// one beyond a limit of the program, as a row that is too large.
    pub(super) const REFUSALS: [&str; 3] = ["22", "23", "54"];
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
    /// A text has a character that the database cannot keep in one: NUL.
    #[error("no text for the database: {0}")]
    Unkeepable(sqlx::Error),
    /// The database cannot hold a value, or a constraint forbids it.
    #[error("refused by the database: {0}")]
    Refused(sqlx::Error),
    /// The database failed or is out of reach.
    #[error("database: {0}")]
    Database(sqlx::Error),
    /// The database has not answered in time; whether it did what was asked is not known.
    #[error("database: no answer in time")]
    Silent,
    /// The file of the database is not as it was written.
    #[error(
        "its database is damaged ({0}); it is left as it is. Keep a copy of the folder, and restore \
         a backup into a new one with `servoscope restore FILE --data-dir DIR`"
    )]
    Damaged(String),
    /// A newer version has changed the tables.
    #[error(
        "a newer version of servoscope has changed its tables; start that version, or restore a \
         backup from before into an empty folder or database"
    )]
    Newer,
    /// The tables are those of an older version, or there are none.
    #[error(
        "its tables are not those of this version; start `servoscope serve` of this version on it \
         once, or use the version that made them"
    )]
    Older,
    /// The tables could not be brought to the form this version needs.
    #[error("migrating the database: {0}")]
    Migration(MigrateError),
    /// The folder of the database cannot be used.
    #[error("data directory: {0}")]
    Directory(#[from] std::io::Error),
}

impl From<MigrateError> for StoreError {
    fn from(error: MigrateError) -> Self {
        match error {
            MigrateError::VersionMissing(_) => Self::Newer,
            error => Self::Migration(error),
        }
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        // A value that the driver cannot send is refused before the database sees it.
        if matches!(error, sqlx::Error::Encode(_)) {
            return Self::Refused(error);
        }
        match error.as_database_error().and_then(lacking) {
            Some(Lacking::Room) => Self::Full(error),
            Some(Lacking::Permission) => Self::ReadOnly(error),
            Some(Lacking::Soundness) => Self::Damaged(error.to_string()),
            Some(Lacking::Character) => Self::Unkeepable(error),
            Some(Lacking::Validity) => Self::Refused(error),
            None => Self::Database(error),
        }
    }
}

impl StoreError {
    /// Whether the same values would be refused again, however often they are written. A full disk, a
    /// database that is away, locked or silent, and transactions that are in each other's way pass.
    pub fn is_permanent(&self) -> bool {
        matches!(self, Self::Refused(_) | Self::Unkeepable(_))
    }

    /// Whether another process has the file of SQLite for itself.
    pub(super) fn is_locked(&self) -> bool {
        let Self::Database(error) = self else { return false };
        let code = error.as_database_error().and_then(|error| error.code()?.parse::<u32>().ok());
        code.is_some_and(|code| code & 0xff == sqlite_code::BUSY)
    }
}

/// What a database lacks that refuses what is asked.
enum Lacking {
    Room,
    Permission,
    Soundness,
    Character,
    Validity,
}

fn lacking(error: &dyn DatabaseError) -> Option<Lacking> {
    if let Some(error) = error.try_downcast_ref::<PgDatabaseError>() {
        return match error.code() {
            postgres_code::DISK_FULL => Some(Lacking::Room),
            postgres_code::READ_ONLY => Some(Lacking::Permission),
            postgres_code::NOT_IN_ENCODING | postgres_code::UNTRANSLATABLE => {
                Some(Lacking::Character)
            }
            code if code.get(..2).is_some_and(|class| postgres_code::REFUSALS.contains(&class)) => {
                Some(Lacking::Validity)
            }
            _ => None,
        };
    }
    let code = error.code()?.parse::<u32>().ok()?;
    // The low byte of an extended result code says what kind of error it is.
    match code & 0xff {
        sqlite_code::FULL => Some(Lacking::Room),
        sqlite_code::READONLY => Some(Lacking::Permission),
        sqlite_code::CORRUPT | sqlite_code::NOT_A_DATABASE => Some(Lacking::Soundness),
        // The tables have no trigger that raises anything: somebody added one, and may remove it.
        sqlite_code::CONSTRAINT if code == sqlite_code::RAISED => None,
        sqlite_code::TOO_BIG | sqlite_code::CONSTRAINT | sqlite_code::MISMATCH => {
            Some(Lacking::Validity)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
