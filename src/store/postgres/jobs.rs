//! Jobs and their results.

use sqlx::{PgConnection, PgPool};

use crate::store::decode::label_pairs;
use crate::store::{IdempotencyKey, Inserted, JobFilter, JobRow, NewJobRow, Page, Reach};

use super::{idempotency, locks};

pub(super) async fn insert(
    connection: &mut PgConnection,
    reach: &Reach,
    row: &NewJobRow,
    key: Option<&IdempotencyKey>,
) -> sqlx::Result<Inserted> {
    let claim = idempotency::claim(connection, reach, "job", key, &row.id).await?;
    if claim != Inserted::Created {
        return Ok(claim);
    }
    // Two jobs of one submitter must not take the same turn. One after that of the job that was
    // taken last, so that turns go on however short the queue is.
    locks::wait_for(connection, locks::SUBMITTER, &row.submitter).await?;
    sqlx::query(
        "INSERT INTO jobs
             (id, measurement_id, kind, request, submitter, status, created_at_ms, turn, owner,
              priority)
         SELECT $1, $2, $3, $4, $5, 'queued', now_ms,
                greatest(last_value + 1,
                         COALESCE((SELECT max(turn) + 1 FROM queue
                                   WHERE NOT running AND turn >= last_value
                                     AND submitter = $5), 0)), $6, $7
         FROM clock, lowest_turn",
    )
    .bind(&row.id)
    .bind(&row.measurement_id)
    .bind(&row.kind)
    .bind(&row.request)
    .bind(&row.submitter)
    .bind(&reach.owner)
    .bind(row.priority.rank())
    .execute(connection)
    .await?;
    Ok(claim)
}

pub(super) async fn get(pool: &PgPool, reach: &Reach, id: &str) -> sqlx::Result<Option<JobRow>> {
    sqlx::query_as(
        "SELECT id, measurement_id, kind, request, status, progress, attempt, cancel_requested,
                created_at_ms, started_at_ms, finished_at_ms, failure, batch_id
         FROM jobs WHERE id = $1 AND ($2 IS NULL OR owner = $2)",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_optional(pool)
    .await
}

pub(super) async fn list(
    pool: &PgPool,
    reach: &Reach,
    filter: &JobFilter,
    page: &Page,
) -> sqlx::Result<Vec<JobRow>> {
    sqlx::query_as(
        "SELECT id, measurement_id, kind, request, status, progress, attempt, cancel_requested,
                created_at_ms, started_at_ms, finished_at_ms, failure, batch_id
         FROM jobs
         WHERE ($1 IS NULL OR id < $1)
           AND ($2 IS NULL OR status = $2)
           AND ($3 IS NULL OR measurement_id = $3)
           AND ($4 IS NULL OR kind = $4)
           AND ($5 IS NULL OR created_at_ms >= $5)
           AND ($6 IS NULL OR created_at_ms < $6)
           AND ($10 IS NULL OR result::json ->> 'verdict' = $10)
           AND ($7 IS NULL AND $8 IS NULL AND $9 = '[]' AND $11 IS NULL OR EXISTS (
               SELECT 1 FROM measurements
               WHERE measurements.id = jobs.measurement_id
                 AND ($7 IS NULL OR machine = $7)
                 AND ($8 IS NULL OR axis = $8)
                 AND NOT EXISTS (
                     SELECT 1 FROM json_array_elements($9::json) AS wanted (pair)
                     WHERE labels::json ->> (pair ->> 0) IS DISTINCT FROM pair ->> 1)
                 AND ($11 IS NULL
                      OR strpos(lower(concat_ws(chr(10), name, machine, axis, operator, labels)),
                                lower($11 COLLATE \"C\")) > 0
                      OR EXISTS (SELECT 1 FROM measurement_files AS file
                                 WHERE file.measurement_id = measurements.id
                                   AND strpos(lower(file.name), lower($11 COLLATE \"C\")) > 0))))
           AND ($13 IS NULL OR owner = $13)
           AND ($14 IS NULL OR batch_id = $14)
         ORDER BY id DESC LIMIT $12",
    )
    .bind(&page.before)
    .bind(filter.status)
    .bind(&filter.measurement_id)
    .bind(&filter.kind)
    .bind(filter.since_ms)
    .bind(filter.until_ms)
    .bind(&filter.machine)
    .bind(&filter.axis)
    .bind(label_pairs(&filter.labels))
    .bind(&filter.verdict)
    .bind(&filter.text)
    .bind(i64::from(page.limit))
    .bind(reach.read())
    .bind(&filter.batch_id)
    .fetch_all(pool)
    .await
}

pub(super) async fn delete(
    connection: &mut PgConnection,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<bool> {
    let done = sqlx::query("DELETE FROM jobs WHERE id = $1 AND ($2 IS NULL OR owner = $2)")
        .bind(id)
        .bind(reach.changed())
        .execute(&mut *connection)
        .await?;
    if done.rows_affected() == 0 {
        return Ok(false);
    }
    sqlx::query("DELETE FROM idempotency_keys WHERE resource_id = $1")
        .bind(id)
        .execute(connection)
        .await?;
    Ok(true)
}

pub(super) async fn result(pool: &PgPool, reach: &Reach, id: &str) -> sqlx::Result<Option<String>> {
    sqlx::query_scalar(
        "SELECT result FROM jobs
         WHERE id = $1 AND result IS NOT NULL AND ($2 IS NULL OR owner = $2)",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_optional(pool)
    .await
}
