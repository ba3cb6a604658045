//! The schema, as steps from one version to the next.

use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::{PgPool, SqlSafeStr as _};

use crate::store::StoreError;
use crate::store::versions;

/// Number, what it does, and its statements. A step that was released never changes.
const STEPS: &[(i64, &str, &str)] = &[
    (1, "everything", include_str!("../../../migrations/postgres/0001_everything.sql")),
    (2, "batches", include_str!("../../../migrations/postgres/0002_batches.sql")),
    (
        3,
        "commits and claims",
        include_str!("../../../migrations/postgres/0003_commits_and_claims.sql"),
    ),
    (4, "quotas of a key", include_str!("../../../migrations/postgres/0004_quotas_of_a_key.sql")),
    (5, "priorities", include_str!("../../../migrations/postgres/0005_priorities.sql")),
];

/// Brings a database of any earlier version to this one. Of several processes that start together
/// one does so, and the others wait.
pub(super) async fn run(pool: &PgPool) -> Result<(), StoreError> {
    Ok(all().run(pool).await?)
}

/// Whether a database is of this version.
pub(super) async fn check(pool: &PgPool) -> Result<(), StoreError> {
    let any = "SELECT to_regclass('_sqlx_migrations') IS NOT NULL";
    let done = if sqlx::query_scalar(any).fetch_one(pool).await? {
        let done = "SELECT version FROM _sqlx_migrations WHERE success";
        sqlx::query_scalar(done).fetch_all(pool).await?
    } else {
        Vec::new()
    };
    versions::check(&all(), &done)
}

/// Every step.
fn all() -> Migrator {
    first(STEPS.len())
}

/// How many steps there are.
#[cfg(test)]
pub(in crate::store) const COUNT: usize = STEPS.len();

/// The first steps.
pub(in crate::store) fn first(count: usize) -> Migrator {
    let step = |&(version, description, sql): &(i64, &'static str, &'static str)| {
        let simple = MigrationType::Simple;
        Migration::new(version, description.into(), simple, sql.into_sql_str(), false)
    };
    Migrator::with_migrations(STEPS[..count].iter().map(step).collect())
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
