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
     LIMIT ?2)";

/// Measurements that are old and that no job works on.
const MEASUREMENTS: &str = "DELETE FROM measurements WHERE id IN (
     SELECT id FROM measurements
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
       AND NOT EXISTS (
           SELECT 1 FROM jobs
           WHERE status IN ('queued', 'running')
             AND json_extract(request, '$.validation_measurement_id') = measurements.id)
     LIMIT ?2)";

/// Batches that are old and whose jobs are gone.
const BATCHES: &str = "DELETE FROM batches WHERE id IN (
     SELECT id FROM batches
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.batch_id = batches.id)
     LIMIT ?2)";

/// Keys that nobody repeats any more.
const KEYS: &str = "DELETE FROM idempotency_keys WHERE (owner, scope, key) IN (
     SELECT owner, scope, key FROM idempotency_keys
     WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
        OR (resource_id NOT IN (SELECT id FROM jobs)
            AND resource_id NOT IN (SELECT id FROM measurements)
            AND resource_id NOT IN (SELECT id FROM batches))
     LIMIT ?2)";

pub(super) async fn delete_older(
    connection: &mut SqliteConnection,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Expired> {
    // Jobs first: a measurement goes with the last job on it.
    let jobs = delete(connection, JOBS, age, limit).await?;
    let measurements = delete(connection, MEASUREMENTS, age, limit).await?;
    delete(connection, BATCHES, age, limit).await?;
    delete(connection, KEYS, age, limit).await?;
    Ok(Expired { measurements, jobs })
}

/// Removes so many of what is older, and says how many there were.
async fn delete(
    connection: &mut SqliteConnection,
    statement: &'static str,
    age: Duration,
    limit: u32,
) -> sqlx::Result<u64> {
    let query = sqlx::query(statement).bind(millis(age)).bind(limit);
    Ok(query.execute(connection).await?.rows_affected())
}
