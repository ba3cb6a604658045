//! The convergence history of jobs.

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::{ConvergencePoint, Lease, Reach};

pub(super) async fn append(
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

pub(super) async fn of_latest_attempt(
    pool: &SqlitePool,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Vec<ConvergencePoint>> {
    sqlx::query_as(
        "SELECT seq, stage, cycle, evaluations, best, mean, elapsed_s
         FROM convergence
         WHERE job_id = ?1 AND attempt = (SELECT attempt FROM jobs
                                           WHERE id = ?1 AND (?2 IS NULL OR owner = ?2))
         ORDER BY seq",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_all(pool)
    .await
}

pub(super) async fn from(
    pool: &SqlitePool,
    reach: &Reach,
    id: &str,
    position: i64,
    limit: u32,
) -> sqlx::Result<Vec<ConvergencePoint>> {
    sqlx::query_as(
        "SELECT seq, stage, cycle, evaluations, best, mean, elapsed_s
         FROM convergence
         WHERE job_id = ?1 AND seq >= ?2
           AND (?4 IS NULL OR EXISTS (SELECT 1 FROM jobs WHERE id = ?1 AND owner = ?4))
         ORDER BY attempt, seq LIMIT ?3",
    )
    .bind(id)
    .bind(position)
    .bind(limit)
    .bind(reach.read())
    .fetch_all(pool)
    .await
}
