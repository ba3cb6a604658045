//! Removing what is older than anybody wants to keep.

use std::time::Duration;

use sqlx::PgConnection;

use crate::store::Expired;
use crate::store::decode::millis;

/// Jobs that ended long ago. What another process removes at the same time is passed over.
const JOBS: &str = "DELETE FROM jobs WHERE id IN (
     SELECT id FROM jobs
     WHERE finished_at_ms < (SELECT now_ms FROM clock) - $1
       AND status IN ('succeeded', 'failed', 'cancelled')
     LIMIT $2 FOR UPDATE SKIP LOCKED)";

/// Measurements that are old, held so that nobody queues a job on one of them.
const CANDIDATES: &str = "SELECT id FROM measurements
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
       AND NOT EXISTS (
           SELECT 1 FROM jobs
           WHERE status IN ('queued', 'running')
             AND request::json ->> 'validation_measurement_id' = measurements.id)
     LIMIT $2 FOR UPDATE SKIP LOCKED";

/// Those of them that no job works on, which could still change while they were not held.
const MEASUREMENTS: &str = "DELETE FROM measurements
     WHERE id = ANY($1)
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)";

/// Batches that are old and whose jobs are gone.
const BATCHES: &str = "DELETE FROM batches WHERE id IN (
     SELECT id FROM batches
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
       AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.batch_id = batches.id)
     LIMIT $2 FOR UPDATE SKIP LOCKED)";

/// Keys that nobody repeats any more.
const KEYS: &str = "DELETE FROM idempotency_keys WHERE (owner, scope, key) IN (
     SELECT owner, scope, key FROM idempotency_keys
     WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
        OR (NOT EXISTS (SELECT 1 FROM jobs WHERE id = resource_id)
            AND NOT EXISTS (SELECT 1 FROM measurements WHERE id = resource_id)
            AND NOT EXISTS (SELECT 1 FROM batches WHERE id = resource_id))
     LIMIT $2 FOR UPDATE SKIP LOCKED)";

pub(super) async fn delete_older(
    connection: &mut PgConnection,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Expired> {
    let (age, limit) = (millis(age), i64::from(limit));
    // Jobs first: a measurement goes with the last job on it.
    let jobs = sqlx::query(JOBS).bind(age).bind(limit).execute(&mut *connection).await?;
    let candidates = sqlx::query_scalar::<_, String>(CANDIDATES).bind(age).bind(limit);
    let candidates = candidates.fetch_all(&mut *connection).await?;
    let measurements = sqlx::query(MEASUREMENTS).bind(candidates).execute(&mut *connection).await?;
    sqlx::query(BATCHES).bind(age).bind(limit).execute(&mut *connection).await?;
    sqlx::query(KEYS).bind(age).bind(limit).execute(connection).await?;
    Ok(Expired { measurements: measurements.rows_affected(), jobs: jobs.rows_affected() })
}
