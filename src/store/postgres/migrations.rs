//! The schema, as steps from one version to the next.
//!
//! A step that changes a table waits for every transaction that has used it, and everybody who comes
//! later waits for the step. So it gives up soon, lets the others pass, and is tried again.

use std::time::Duration;

use sqlx::migrate::{Migrate as _, MigrateError, Migration, MigrationType, Migrator};
use sqlx::{Connection as _, PgConnection, PgPool, SqlSafeStr as _};
use tracing::{info, warn};

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
    (6, "runs", include_str!("../../../migrations/postgres/0006_runs.sql")),
    (7, "queue", include_str!("../../../migrations/postgres/0007_queue.sql")),
];

/// Whether any step was done.
const ANY: &str = "SELECT to_regclass('_sqlx_migrations') IS NOT NULL";

/// There are databases that have this step, with the same statements, under another number.
const RENUMBERED: &str =
    "UPDATE _sqlx_migrations SET version = 4 WHERE version = 5 AND description = 'quotas of a key'";

/// How long a statement of a step waits for others, and they for it: less than any lease.
const PATIENCE: &str = "SET lock_timeout = '2s'";

/// How long others pass between two tries.
const PAUSE: Duration = Duration::from_secs(2);

/// What ends a statement that others were in the way of: their lock, or that each waited for the other.
const IN_THE_WAY: [&str; 2] = ["55P03", "40P01"];

/// Brings a database of any earlier version to this one. Of several processes that start together
/// one does so, and the others wait. Transactions that are open for long are waited for.
pub(super) async fn run(pool: &PgPool) -> Result<(), StoreError> {
    // Of its own: the lock and what is set here go with it, however this ends.
    let mut connection = PgConnection::connect_with(&pool.connect_options()).await?;
    alone(&mut connection).await?;
    if sqlx::query_scalar(ANY).fetch_one(&mut connection).await? {
        sqlx::query(RENUMBERED).execute(&mut connection).await?;
    }
    sqlx::query(PATIENCE).execute(&mut connection).await?;
    let mut steps = all();
    steps.set_locking(false);
    // `run` by another name: that one cannot be part of a task that other threads take up.
    while let Err(error) = steps.run_direct(None, &mut connection, false).await {
        if !is_in_the_way(&error) {
            return Err(error.into());
        }
        report(&mut connection, &error).await?;
        tokio::time::sleep(PAUSE).await;
    }
    // Nothing is lost where it fails.
    let _ = connection.close().await;
    Ok(())
}

/// Waits for the lock that every version takes before it changes the tables, however long another
/// process needs for that.
async fn alone(connection: &mut PgConnection) -> Result<(), StoreError> {
    sqlx::query("SET lock_timeout = 0").execute(&mut *connection).await?;
    let mut locked = connection.lock();
    if let Ok(locked) = tokio::time::timeout(PAUSE, &mut locked).await {
        return Ok(locked?);
    }
    info!("another process brings the database up to date; waiting for it");
    Ok(locked.await?)
}

fn is_in_the_way(error: &MigrateError) -> bool {
    let (MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _)) = error else {
        return false;
    };
    let code = error.as_database_error().and_then(|error| error.code());
    code.is_some_and(|code| IN_THE_WAY.contains(&code.as_ref()))
}

/// Says what is waited for: most likely the transaction that is open for longest.
async fn report(connection: &mut PgConnection, error: &MigrateError) -> Result<(), StoreError> {
    let oldest: Option<(i32, String, i64)> = sqlx::query_as(
        "SELECT pid, application_name, extract(epoch FROM clock_timestamp() - xact_start)::bigint
         FROM pg_stat_activity
         WHERE datname = current_database() AND pid <> pg_backend_pid() AND xact_start IS NOT NULL
         ORDER BY xact_start LIMIT 1",
    )
    .fetch_optional(connection)
    .await?;
    let (process, program, open_s) = oldest.unwrap_or_default();
    warn!(
        %error,
        process,
        program,
        open_s,
        "the tables cannot be changed while a transaction uses them; tried again until it has ended"
    );
    Ok(())
}

/// Whether a database is of this version.
pub(super) async fn check(pool: &PgPool) -> Result<(), StoreError> {
    let done = if sqlx::query_scalar(ANY).fetch_one(pool).await? {
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
    use std::time::Instant;

    use super::*;
    use crate::store::contract::cluster::Cluster;

    #[test]
    fn every_file_of_the_folder_is_a_step() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations/postgres");
        let entries = std::fs::read_dir(folder).unwrap();
        assert_eq!(entries.count(), all().iter().count());
    }

    #[tokio::test]
    async fn whoever_uses_the_tables_goes_on_while_a_step_waits_for_a_long_transaction() {
        let Some(cluster) = Cluster::shared() else { return };
        let pool = PgPool::connect(&cluster.database()).await.unwrap();
        first(1).run(&pool).await.unwrap();
        let mut held = pool.begin().await.unwrap();
        let used = "SELECT count(*) FROM jobs";
        sqlx::query(used).execute(&mut *held).await.unwrap();
        let changing = tokio::spawn({
            let pool = pool.clone();
            async move { run(&pool).await }
        });
        let began = Instant::now();
        // Long enough for two tries.
        while began.elapsed() < Duration::from_secs(7) {
            let asked = sqlx::query(used).execute(&pool);
            let answer = tokio::time::timeout(Duration::from_secs(5), asked).await;
            answer.expect("nobody waits for long").unwrap();
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        assert!(!changing.is_finished(), "a transaction that is open is waited for");
        held.rollback().await.unwrap();
        changing.await.unwrap().unwrap();
        check(&pool).await.unwrap();
    }

    #[tokio::test]
    async fn a_process_waits_for_another_that_changes_the_tables() {
        let Some(cluster) = Cluster::shared() else { return };
        let pool = PgPool::connect(&cluster.database()).await.unwrap();
        let mut other = pool.acquire().await.unwrap();
        other.lock().await.unwrap();
        let waiting = tokio::spawn({
            let pool = pool.clone();
            async move { run(&pool).await }
        });
        // Longer than a statement of a step waits.
        tokio::time::sleep(Duration::from_secs(4)).await;
        assert!(!waiting.is_finished());
        other.unlock().await.unwrap();
        waiting.await.unwrap().unwrap();
    }
}
