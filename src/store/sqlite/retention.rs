//! Removing what is older than anybody wants to keep.

use std::time::Duration;

use sqlx::SqliteConnection;

use crate::store::Expired;

use crate::store::decode::millis;

/// Jobs that ended long ago.
const JOBS: &str = "DELETE FROM jobs WHERE id IN (
     SELECT id FROM jobs
     WHERE finished_at_ms < (SELECT now_ms FROM clock) - ?1
       AND status IN ('succeeded', 'failed', 'cancelled')
     LIMIT ?2)
     RETURNING id";

/// Measurements that are old and that no job works on.
const MEASUREMENTS: &str = "DELETE FROM measurements WHERE id IN (
     SELECT id FROM measurements
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
       AND NOT EXISTS (
           SELECT 1 FROM jobs
           WHERE status IN ('queued', 'running')
             AND json_extract(request, '$.validation_measurement_id') = measurements.id)
     LIMIT ?2)
     RETURNING id";

/// Batches that are old and whose jobs are gone.
const BATCHES: &str = "DELETE FROM batches WHERE id IN (
     SELECT id FROM batches
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.batch_id = batches.id)
     LIMIT ?2)
     RETURNING id";

/// Keys of what is gone.
const KEYS: &str = "DELETE FROM idempotency_keys
     WHERE resource_id IN (SELECT value FROM json_each(?1))";

/// Keys that nobody repeats any more.
const OLD_KEYS: &str = "DELETE FROM idempotency_keys WHERE (owner, scope, key) IN (
     SELECT owner, scope, key FROM idempotency_keys
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
     LIMIT ?2)";

pub(super) async fn delete_older(
    connection: &mut SqliteConnection,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Expired> {
    // Jobs first: a measurement goes with the last job on it.
    let mut gone = delete(connection, JOBS, age, limit).await?;
    let jobs = gone.len() as u64;
    let measurements = delete(connection, MEASUREMENTS, age, limit).await?;
    let deleted = Expired { measurements: measurements.len() as u64, jobs };
    gone.extend(measurements);
    gone.extend(delete(connection, BATCHES, age, limit).await?);
    let gone = serde_json::json!(gone).to_string();
    sqlx::query(KEYS).bind(gone).execute(&mut *connection).await?;
    let old = sqlx::query(OLD_KEYS).bind(millis(age)).bind(limit);
    old.execute(connection).await?;
    Ok(deleted)
}

/// Removes so many of what is older, and says which.
async fn delete(
    connection: &mut SqliteConnection,
    statement: &'static str,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Vec<String>> {
    sqlx::query_scalar(statement).bind(millis(age)).bind(limit).fetch_all(connection).await
}
