//! The schema, as steps from one version to the next.

use sqlx::SqlSafeStr as _;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// Number, what it does, and its statements. A step that was released never changes.
const STEPS: &[(i64, &str, &str)] = &[
    (1, "everything", include_str!("../../../migrations/postgres/0001_everything.sql")),
    (2, "batches", include_str!("../../../migrations/postgres/0002_batches.sql")),
];

/// Every step, to be run on a database of any earlier version. Processes that start together run
/// them one after the other.
pub(super) fn all() -> Migrator {
    let step = |&(version, description, sql): &(i64, &'static str, &'static str)| {
        let simple = MigrationType::Simple;
        Migration::new(version, description.into(), simple, sql.into_sql_str(), false)
    };
    Migrator::with_migrations(STEPS.iter().map(step).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn every_file_of_the_folder_is_a_step() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations/postgres");
        let entries = std::fs::read_dir(folder).unwrap();
        assert_eq!(entries.count(), all().iter().count());
    }
}
