//! The schema, as steps from one version to the next.

use sqlx::SqlSafeStr as _;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// Number, what it does, and its statements; a step that was released never changes.
const STEPS: &[(i64, &str, &str)] = &[
    (
        1,
        "measurements and jobs",
        include_str!("../../../migrations/0001_measurements_and_jobs.sql"),
    ),
    (
        2,
        "lists deletion and history",
        include_str!("../../../migrations/0002_lists_deletion_and_history.sql"),
    ),
    (
        3,
        "webhooks and deliveries",
        include_str!("../../../migrations/0003_webhooks_and_deliveries.sql"),
    ),
    (4, "mappings", include_str!("../../../migrations/0004_mappings.sql")),
];

/// Every step, to be run on a database of any earlier version.
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
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        files.sort();
        let name = |step: &Migration| {
            format!("{:04}_{}.sql", step.version, step.description.replace(' ', "_"))
        };
        let listed: Vec<String> = all().iter().map(name).collect();
        assert_eq!(listed, files);
    }
}
