//! Whether a database is of the version of this program.

use sqlx::migrate::Migrator;

use super::StoreError;

/// Compares the steps that a database has had with those that this program knows.
pub(super) fn check(known: &Migrator, done: &[i64]) -> Result<(), StoreError> {
    if done.iter().any(|version| !known.version_exists(*version)) {
        Err(StoreError::Newer)
    } else if known.iter().any(|step| !done.contains(&step.version)) {
        Err(StoreError::Older)
    } else {
        Ok(())
    }
}
