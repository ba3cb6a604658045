//! The convergence history of jobs.

use sqlx::{PgConnection, PgPool};

use crate::store::{ConvergencePoint, Lease, Reach};

pub(super) async fn append(
    connection: &mut PgConnection,
    lease: &Lease,
    rows: &[ConvergencePoint],
) -> sqlx::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    // A heartbeat whose answer was lost is sent again with the same rows.
    sqlx::query(
        "INSERT INTO convergence
             (job_id, attempt, seq, stage, cycle, evaluations, best, mean, elapsed_s)
         SELECT $1, $2, * FROM unnest($3::bigint[], $4::text[], $5::bigint[], $6::bigint[],
                                      $7::float8[], $8::float8[], $9::float8[])
         ON CONFLICT DO NOTHING",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .bind(rows.iter().map(|row| row.seq).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.stage.as_str()).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.cycle).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.evaluations).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.best).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.mean).collect::<Vec<_>>())
    .bind(rows.iter().map(|row| row.elapsed_s).collect::<Vec<_>>())
    .execute(connection)
    .await?;
    Ok(())
}

pub(super) async fn of_latest_attempt(
    pool: &PgPool,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Vec<ConvergencePoint>> {
    sqlx::query_as(
        "SELECT seq, stage, cycle, evaluations, best, mean, elapsed_s
         FROM convergence
         WHERE job_id = $1 AND attempt = (SELECT attempt FROM jobs
                                           WHERE id = $1 AND ($2 IS NULL OR owner = $2))
         ORDER BY seq",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_all(pool)
    .await
}

pub(super) async fn from(
    pool: &PgPool,
    reach: &Reach,
    id: &str,
    position: i64,
    limit: u32,
) -> sqlx::Result<Vec<ConvergencePoint>> {
    sqlx::query_as(
        "SELECT seq, stage, cycle, evaluations, best, mean, elapsed_s
         FROM convergence
         WHERE job_id = $1 AND seq >= $2
           AND ($4 IS NULL OR EXISTS (SELECT 1 FROM jobs WHERE id = $1 AND owner = $4))
         ORDER BY attempt, seq LIMIT $3",
    )
    .bind(id)
    .bind(position)
    .bind(i64::from(limit))
    .bind(reach.read())
    .fetch_all(pool)
    .await
}
