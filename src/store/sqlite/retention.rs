//! Removing what is older than anybody wants to keep.

use std::time::Duration;

use sqlx::SqliteConnection;

use crate::store::Expired;

use super::queue::millis;

pub(super) async fn delete_older(
    connection: &mut SqliteConnection,
    age: Duration,
    limit: u32,
) -> sqlx::Result<Expired> {
    let age_ms = millis(age);
    // Jobs first: a measurement goes with the last job on it.
    let jobs = jobs(connection, age_ms, limit).await?;
    let measurements = measurements(connection, age_ms, limit).await?;
    keys(connection, age_ms, limit).await?;
    Ok(Expired { measurements, jobs })
}

/// Removes jobs that ended long ago.
async fn jobs(connection: &mut SqliteConnection, age_ms: i64, limit: u32) -> sqlx::Result<u64> {
    let done = sqlx::query(
        "DELETE FROM jobs WHERE id IN (
             SELECT id FROM jobs
             WHERE finished_at_ms < (SELECT now_ms FROM clock) - ?1
               AND status IN ('succeeded', 'failed', 'cancelled')
             LIMIT ?2)",
    )
    .bind(age_ms)
    .bind(limit)
    .execute(connection)
    .await?;
    Ok(done.rows_affected())
}

/// Removes measurements that are old and that no job works on.
async fn measurements(
    connection: &mut SqliteConnection,
    age_ms: i64,
    limit: u32,
) -> sqlx::Result<u64> {
    let done = sqlx::query(
        "DELETE FROM measurements WHERE id IN (
             SELECT id FROM measurements
             WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
               AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.measurement_id = measurements.id)
               AND NOT EXISTS (
                   SELECT 1 FROM jobs
                   WHERE status IN ('queued', 'running')
                     AND json_extract(request, '$.validation_measurement_id') = measurements.id)
             LIMIT ?2)",
    )
    .bind(age_ms)
    .bind(limit)
    .execute(connection)
    .await?;
    Ok(done.rows_affected())
}

/// Forgets keys that nobody repeats any more.
async fn keys(connection: &mut SqliteConnection, age_ms: i64, limit: u32) -> sqlx::Result<()> {
    sqlx::query(
        "DELETE FROM idempotency_keys WHERE (scope, key) IN (
             SELECT scope, key FROM idempotency_keys
             WHERE created_at_ms < (SELECT now_ms FROM clock) - ?1
                OR (resource_id NOT IN (SELECT id FROM jobs)
                    AND resource_id NOT IN (SELECT id FROM measurements))
             LIMIT ?2)",
    )
    .bind(age_ms)
    .bind(limit)
    .execute(connection)
    .await?;
    Ok(())
}
