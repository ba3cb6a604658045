//! The schema, as steps from one version to the next.

use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::{SqlSafeStr as _, SqlitePool};

use crate::store::StoreError;
use crate::store::versions;

/// Number, what it does, and its statements.
type Step = (i64, &'static str, &'static str);

/// A step that was released never changes. Numbers may be left out; a step with a number below those
/// that a database has had is run, too.
const STEPS: &[Step] = &[
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
    (5, "keys", include_str!("../../../migrations/0005_keys.sql")),
    (6, "limits", include_str!("../../../migrations/0006_limits.sql")),
    (7, "batches", include_str!("../../../migrations/0007_batches.sql")),
    (8, "quotas of a key", include_str!("../../../migrations/0008_quotas_of_a_key.sql")),
    (9, "priorities", include_str!("../../../migrations/0009_priorities.sql")),
    (10, "runs", include_str!("../../../migrations/0010_runs.sql")),
    (11, "keys by age", include_str!("../../../migrations/0011_keys_by_age.sql")),
];

/// Whether any step was done.
const ANY: &str = "SELECT EXISTS (SELECT 1 FROM sqlite_master WHERE name = '_sqlx_migrations')";

/// There are databases that have this step, with the same statements, under another number.
const RENUMBERED: &str =
    "UPDATE _sqlx_migrations SET version = 8 WHERE version = 9 AND description = 'quotas of a key'";

/// Brings a database of any earlier version to this one. Of several processes that start together
/// one does so, and the others wait.
pub(super) async fn run(writer: &SqlitePool) -> Result<(), StoreError> {
    let mut transaction = writer.begin_with("BEGIN IMMEDIATE").await?;
    if sqlx::query_scalar(ANY).fetch_one(&mut *transaction).await? {
        sqlx::query(RENUMBERED).execute(&mut *transaction).await?;
    }
    all().run_direct(None, &mut *transaction, false).await?;
    transaction.commit().await?;
    Ok(())
}

/// Whether a database is of this version.
pub(super) async fn check(readers: &SqlitePool) -> Result<(), StoreError> {
    let done = if sqlx::query_scalar(ANY).fetch_one(readers).await? {
        let done = "SELECT version FROM _sqlx_migrations WHERE success";
        sqlx::query_scalar(done).fetch_all(readers).await?
    } else {
        Vec::new()
    };
    versions::check(&all(), &done)
}

/// Every step.
fn all() -> Migrator {
    of(STEPS)
}

/// How many steps there are.
#[cfg(test)]
pub(in crate::store) const COUNT: usize = STEPS.len();

/// The first steps.
#[cfg(test)]
pub(in crate::store) fn first(count: usize) -> Migrator {
    of(&STEPS[..count])
}

fn of(steps: &'static [Step]) -> Migrator {
    let step = |&(version, description, sql): &Step| {
        let simple = MigrationType::Simple;
        Migration::new(version, description.into(), simple, sql.into_sql_str(), false)
    };
    Migrator::with_migrations(steps.iter().map(step).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use sqlx::sqlite::SqlitePoolOptions;

    use super::*;

    #[test]
    fn every_file_of_the_folder_is_a_step() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(Result::unwrap)
            .filter(|entry| entry.file_type().unwrap().is_file())
            .map(|entry| entry.file_name().into_string().unwrap())
            .collect();
        files.sort();
        let name = |step: &Migration| {
            format!("{:04}_{}.sql", step.version, step.description.replace(' ', "_"))
        };
        let listed: Vec<String> = all().iter().map(name).collect();
        assert_eq!(listed, files);
    }

    #[tokio::test]
    async fn a_step_that_arrives_after_a_later_one_is_run_too() {
        const ONE: Step = (1, "one", "CREATE TABLE one (x INTEGER)");
        const TWO: Step = (2, "two", "ALTER TABLE one ADD COLUMN y INTEGER");
        const THREE: Step = (3, "three", "CREATE TABLE three (x INTEGER)");
        let pool = SqlitePoolOptions::new().max_connections(1);
        let pool = pool.connect("sqlite::memory:").await.unwrap();
        of(&[ONE, THREE]).run(&pool).await.unwrap();
        for _ in 0..2 {
            of(&[ONE, TWO, THREE]).run(&pool).await.unwrap();
            sqlx::query("SELECT one.y, three.x FROM one, three").execute(&pool).await.unwrap();
        }
    }
}
