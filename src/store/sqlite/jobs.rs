//! Jobs, their results and their convergence history.

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::{ConvergencePoint, JobFilter, JobRow, Lease, NewJobRow, Page};

pub(super) async fn insert(connection: &mut SqliteConnection, row: &NewJobRow) -> sqlx::Result<()> {
    sqlx::query(
        "INSERT INTO jobs (id, measurement_id, kind, request, status, created_at_ms)
         VALUES (?1, ?2, ?3, ?4, 'queued', (SELECT now_ms FROM clock))",
    )
    .bind(&row.id)
    .bind(&row.measurement_id)
    .bind(&row.kind)
    .bind(&row.request)
    .execute(connection)
    .await?;
    Ok(())
}

pub(super) async fn get(pool: &SqlitePool, id: &str) -> sqlx::Result<Option<JobRow>> {
    sqlx::query_as(
        "SELECT id, measurement_id, kind, request, status, progress, attempt, cancel_requested,
                created_at_ms, started_at_ms, finished_at_ms, failure
         FROM jobs WHERE id = ?1",
    )
    .bind(id)
    .fetch_optional(pool)
    .await
}

pub(super) async fn list(
    pool: &SqlitePool,
    filter: &JobFilter,
    page: &Page,
) -> sqlx::Result<Vec<JobRow>> {
    sqlx::query_as(
        "SELECT id, measurement_id, kind, request, status, progress, attempt, cancel_requested,
                created_at_ms, started_at_ms, finished_at_ms, failure
         FROM jobs
         WHERE (?1 IS NULL OR id < ?1)
           AND (?2 IS NULL OR status = ?2)
           AND (?3 IS NULL OR measurement_id = ?3)
         ORDER BY id DESC LIMIT ?4",
    )
    .bind(&page.before)
    .bind(filter.status)
    .bind(&filter.measurement_id)
    .bind(page.limit)
    .fetch_all(pool)
    .await
}

pub(super) async fn result(pool: &SqlitePool, id: &str) -> sqlx::Result<Option<String>> {
    sqlx::query_scalar("SELECT result FROM jobs WHERE id = ?1 AND result IS NOT NULL")
        .bind(id)
        .fetch_optional(pool)
        .await
}

pub(super) async fn append_convergence(
    connection: &mut SqliteConnection,
    lease: &Lease,
    rows: &[ConvergencePoint],
) -> sqlx::Result<()> {
    for row in rows {
        // A heartbeat whose answer was lost is sent again with the same rows.
        sqlx::query(
            "INSERT INTO convergence
                 (job_id, attempt, seq, stage, cycle, evaluations, best, mean, elapsed_s)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)
             ON CONFLICT DO NOTHING",
        )
        .bind(&lease.job_id)
        .bind(lease.attempt)
        .bind(row.seq)
        .bind(&row.stage)
        .bind(row.cycle)
        .bind(row.evaluations)
        .bind(row.best)
        .bind(row.mean)
        .bind(row.elapsed_s)
        .execute(&mut *connection)
        .await?;
    }
    Ok(())
}

pub(super) async fn convergence(
    pool: &SqlitePool,
    id: &str,
) -> sqlx::Result<Vec<ConvergencePoint>> {
    sqlx::query_as(
        "SELECT seq, stage, cycle, evaluations, best, mean, elapsed_s
         FROM convergence
         WHERE job_id = ?1 AND attempt = (SELECT attempt FROM jobs WHERE id = ?1)
         ORDER BY seq",
    )
    .bind(id)
    .fetch_all(pool)
    .await
}
