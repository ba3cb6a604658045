//! Results with what they are of, over the time of measuring.

use sqlx::PgPool;

use crate::store::{AxisRow, Reach, ResultFilter, StoredResult};

pub(super) async fn list(
    pool: &PgPool,
    reach: &Reach,
    filter: &ResultFilter,
    limit: u32,
) -> sqlx::Result<Vec<StoredResult>> {
    sqlx::query_as(
        "SELECT jobs.id AS job_id, jobs.result, measured.id AS measurement_id,
                measured.name, measured.machine, measured.axis, measured.at_ms
         FROM jobs
         JOIN (SELECT id, name, machine, axis, coalesce(measured_at_ms, created_at_ms) AS at_ms
               FROM measurements) AS measured ON measured.id = jobs.measurement_id
         WHERE jobs.result IS NOT NULL
           AND ($8 IS NULL OR jobs.owner = $8)
           AND ($1 IS NULL OR machine = $1)
           AND ($2 IS NULL OR axis = $2)
           AND ($3 IS NULL OR measured.id = $3)
           AND ($4 IS NULL OR at_ms >= $4)
           AND ($5 IS NULL OR at_ms < $5)
           AND (NOT $6 OR NOT EXISTS (
               SELECT 1 FROM jobs AS later
               WHERE later.measurement_id = measured.id AND later.result IS NOT NULL
                 AND later.id > jobs.id AND ($8 IS NULL OR later.owner = $8)))
         ORDER BY at_ms DESC, jobs.id DESC LIMIT $7",
    )
    .bind(&filter.machine)
    .bind(&filter.axis)
    .bind(&filter.measurement_id)
    .bind(filter.from_ms)
    .bind(filter.to_ms)
    .bind(filter.latest_only)
    .bind(i64::from(limit))
    .bind(reach.read())
    .fetch_all(pool)
    .await
}

pub(super) async fn axes(
    pool: &PgPool,
    reach: &Reach,
    machine: Option<&str>,
    limit: u32,
) -> sqlx::Result<Vec<AxisRow>> {
    sqlx::query_as(
        "SELECT machine, axis, count(*) AS measurements,
                count(*) FILTER (WHERE EXISTS (
                    SELECT 1 FROM jobs
                    WHERE measurement_id = measured.id AND result IS NOT NULL
                      AND ($3 IS NULL OR owner = $3))) AS results,
                min(at_ms) AS first_ms, max(at_ms) AS last_ms
         FROM (SELECT id, machine, axis, coalesce(measured_at_ms, created_at_ms) AS at_ms
               FROM measurements
               WHERE axis IS NOT NULL AND machine IS NOT NULL
                 AND ($1 IS NULL OR machine = $1)
                 AND ($3 IS NULL OR owner = $3)) AS measured
         GROUP BY machine, axis ORDER BY machine, axis LIMIT $2",
    )
    .bind(machine)
    .bind(i64::from(limit))
    .bind(reach.read())
    .fetch_all(pool)
    .await
}
