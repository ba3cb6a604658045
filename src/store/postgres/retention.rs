//! Removing what is older than anybody wants to keep.

use std::time::Duration;

use sqlx::PgConnection;

use crate::store::Expired;
use crate::store::decode::millis;

/// Jobs that ended long ago. What another process removes at the same time is passed over.
const JOBS: &str = "DELETE FROM jobs WHERE id = ANY(ARRAY(
     SELECT id FROM jobs
     WHERE finished_at_ms < (SELECT now_ms FROM clock) - $1
       AND status IN ('succeeded', 'failed', 'cancelled')
     LIMIT $2 FOR UPDATE SKIP LOCKED))
     RETURNING id";

/// Measurements that are old, held so that nobody queues a job on one of them.
const CANDIDATES: &str = "SELECT id FROM measurements
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
       AND NOT EXISTS (
           SELECT 1 FROM queue JOIN jobs ON jobs.id = queue.job_id
           WHERE request::json ->> 'validation_measurement_id' = measurements.id)
     LIMIT $2 FOR UPDATE SKIP LOCKED";

/// Those of them that no job works on, which could still change while they were not held; and a job may
/// use one as its second whether it is held or not.
const MEASUREMENTS: &str = "DELETE FROM measurements
     WHERE id = ANY($1)
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
       AND NOT EXISTS (
           SELECT 1 FROM queue JOIN jobs ON jobs.id = queue.job_id
           WHERE request::json ->> 'validation_measurement_id' = measurements.id)
     RETURNING id";

/// Batches that are old and whose jobs are gone.
const BATCHES: &str = "DELETE FROM batches WHERE id = ANY(ARRAY(
     SELECT id FROM batches
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.batch_id = batches.id)
     LIMIT $2 FOR UPDATE SKIP LOCKED))
     RETURNING id";

/// Keys of what is gone. Whoever deletes a measurement holds those of its jobs before the jobs: they are
/// not waited for.
const KEYS: &str = "DELETE FROM idempotency_keys WHERE (owner, scope, key) IN (
     SELECT owner, scope, key FROM idempotency_keys
     WHERE resource_id = ANY($1) FOR UPDATE SKIP LOCKED)";

/// Keys that nobody repeats any more.
const OLD_KEYS: &str = "DELETE FROM idempotency_keys WHERE (owner, scope, key) IN (
     SELECT owner, scope, key FROM idempotency_keys
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
     LIMIT $2 FOR UPDATE SKIP LOCKED)";

pub(super) async fn delete_older(
    connection: &mut PgConnection,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Expired> {
    // Jobs first: a measurement goes with the last job on it.
    let mut gone = older(connection, JOBS, age, limit).await?;
    let jobs = gone.len() as u64;
    let candidates = older(connection, CANDIDATES, age, limit).await?;
    let measurements = delete_unused(connection, candidates).await?;
    let deleted = Expired { measurements: measurements.len() as u64, jobs };
    gone.extend(measurements);
    gone.extend(older(connection, BATCHES, age, limit).await?);
    sqlx::query(KEYS).bind(gone).execute(&mut *connection).await?;
    let old = sqlx::query(OLD_KEYS).bind(millis(age)).bind(i64::from(limit));
    old.execute(connection).await?;
    Ok(deleted)
}

/// The ids that a statement gives of so many of what is older.
async fn older(
    connection: &mut PgConnection,
    statement: &'static str,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Vec<String>> {
    let ids = sqlx::query_scalar(statement).bind(millis(age)).bind(i64::from(limit));
    ids.fetch_all(connection).await
}

/// Removes the candidates that no job works on, and says which.
async fn delete_unused(
    connection: &mut PgConnection,
    candidates: Vec<String>,
) -> sqlx::Result<Vec<String>> {
    sqlx::query_scalar(MEASUREMENTS).bind(candidates).fetch_all(connection).await
}

#[cfg(test)]
mod tests {
    use sqlx::{PgPool, raw_sql};

    use super::*;
    use crate::store::contract::cluster::Cluster;
    use crate::store::postgres::migrations;

    /// One is old, the other is not.
    const MEASURED: &str = "INSERT INTO measurements (id, created_at_ms, owner, labels, sha256,
             experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
             omega_max_rad_s, notes)
         SELECT id, at, '', '{}', '', 1, 1, 1, 1, 1, 1, '[]'
         FROM (VALUES ('old', 1), ('new', 9000000000000)) AS row (id, at)";

    /// Fits the new one, and measures its gain on the old one.
    const JOB: &str = r#"INSERT INTO jobs (id, measurement_id, owner, submitter, turn, kind, request,
             status, created_at_ms)
         VALUES ('job', 'new', '', '', 0, 'diagnose', '{"validation_measurement_id": "old"}',
             'queued', 1)"#;

    #[tokio::test]
    async fn an_old_measurement_stays_where_a_job_that_uses_it_is_queued_at_the_same_time() {
        let Some(cluster) = Cluster::shared() else { return };
        let pool = PgPool::connect(&cluster.database()).await.unwrap();
        migrations::run(&pool).await.unwrap();
        raw_sql(MEASURED).execute(&pool).await.unwrap();
        let mut transaction = pool.begin().await.unwrap();
        let candidates = older(&mut transaction, CANDIDATES, Duration::ZERO, 10).await.unwrap();
        assert_eq!(candidates, ["old"]);
        raw_sql(JOB).execute(&pool).await.unwrap();
        let deleted = delete_unused(&mut transaction, candidates.clone()).await.unwrap();
        assert!(deleted.is_empty(), "{deleted:?}");
        let end = "UPDATE jobs SET status = 'cancelled', finished_at_ms = 1";
        raw_sql(end).execute(&pool).await.unwrap();
        assert_eq!(delete_unused(&mut transaction, candidates).await.unwrap(), ["old"]);
    }
}
