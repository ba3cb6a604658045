//! The lease queue: what moves a job from one status to the next.

use std::time::Duration;

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::{
    Beat, Cancelling, ConvergencePoint, EndedRow, Lease, MAX_ATTEMPTS, Outcome, QueueState, Reach,
    Recovered, Status,
};

use super::history;

pub(super) async fn lease(
    connection: &mut SqliteConnection,
    duration: Duration,
) -> sqlx::Result<Option<Lease>> {
    sqlx::query_as(
        "UPDATE jobs
         SET status = 'running', attempt = attempt + 1, progress = NULL,
             started_at_ms = (SELECT now_ms FROM clock),
             lease_until_ms = (SELECT now_ms FROM clock) + ?1
         WHERE id = (SELECT id FROM jobs WHERE status = 'queued' ORDER BY id LIMIT 1)
         RETURNING id AS job_id, attempt, measurement_id, kind, request,
                   (SELECT COALESCE(max(seq) + 1, 0) FROM convergence
                    WHERE job_id = jobs.id) AS next_seq",
    )
    .bind(millis(duration))
    .fetch_optional(connection)
    .await
}

pub(super) async fn renew(
    connection: &mut SqliteConnection,
    lease: &Lease,
    duration: Duration,
    progress: Option<&str>,
    rows: &[ConvergencePoint],
) -> sqlx::Result<Beat> {
    let cancel_requested: Option<bool> = sqlx::query_scalar(
        "UPDATE jobs
         SET lease_until_ms = (SELECT now_ms FROM clock) + ?3, progress = COALESCE(?4, progress)
         WHERE id = ?1 AND attempt = ?2 AND status = 'running'
           AND lease_until_ms > (SELECT now_ms FROM clock)
         RETURNING cancel_requested",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .bind(millis(duration))
    .bind(progress)
    .fetch_optional(&mut *connection)
    .await?;
    let Some(cancel_requested) = cancel_requested else { return Ok(Beat::Lost) };
    history::append(connection, lease, rows).await?;
    Ok(Beat::Renewed { cancel_requested })
}

pub(super) async fn finish(
    connection: &mut SqliteConnection,
    lease: &Lease,
    outcome: &Outcome,
) -> sqlx::Result<bool> {
    let (result, failure) = match outcome {
        Outcome::Succeeded(result) => (Some(result), None),
        Outcome::Failed(failure) => (None, Some(failure)),
        Outcome::Cancelled => (None, None),
    };
    let done = sqlx::query(
        "UPDATE jobs
         SET status = ?3, result = ?4, failure = ?5, lease_until_ms = NULL,
             finished_at_ms = (SELECT now_ms FROM clock)
         WHERE id = ?1 AND attempt = ?2 AND status = 'running'
           AND lease_until_ms > (SELECT now_ms FROM clock)",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .bind(outcome.status())
    .bind(result)
    .bind(failure)
    .execute(connection)
    .await?;
    Ok(done.rows_affected() == 1)
}

pub(super) async fn hand_back(
    connection: &mut SqliteConnection,
    lease: &Lease,
) -> sqlx::Result<bool> {
    let done = sqlx::query(
        "UPDATE jobs
         SET status = CASE WHEN cancel_requested THEN 'cancelled' ELSE 'queued' END,
             finished_at_ms =
                 CASE WHEN cancel_requested THEN (SELECT now_ms FROM clock) ELSE NULL END,
             handed_back = handed_back + 1, lease_until_ms = NULL, progress = NULL
         WHERE id = ?1 AND attempt = ?2 AND status = 'running'
           AND lease_until_ms > (SELECT now_ms FROM clock)",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .execute(connection)
    .await?;
    Ok(done.rows_affected() == 1)
}

pub(super) async fn cancel(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Cancelling> {
    let status: Option<Status> =
        sqlx::query_scalar("SELECT status FROM jobs WHERE id = ?1 AND (?2 IS NULL OR owner = ?2)")
            .bind(id)
            .bind(reach.changed())
            .fetch_optional(&mut *connection)
            .await?;
    match status {
        None => Ok(Cancelling::Unknown),
        Some(Status::Queued) => {
            sqlx::query(
                "UPDATE jobs
                 SET status = 'cancelled', cancel_requested = 1,
                     finished_at_ms = (SELECT now_ms FROM clock)
                 WHERE id = ?1",
            )
            .bind(id)
            .execute(connection)
            .await?;
            Ok(Cancelling::Cancelled)
        }
        Some(Status::Running) => {
            sqlx::query("UPDATE jobs SET cancel_requested = 1 WHERE id = ?1")
                .bind(id)
                .execute(connection)
                .await?;
            Ok(Cancelling::Requested)
        }
        Some(status) => Ok(Cancelling::Ended(status)),
    }
}

pub(super) async fn recover_expired(connection: &mut SqliteConnection) -> sqlx::Result<Recovered> {
    let mut ended: Vec<EndedRow> = sqlx::query_as(
        "UPDATE jobs
         SET status = 'cancelled', lease_until_ms = NULL,
             finished_at_ms = (SELECT now_ms FROM clock)
         WHERE status = 'running' AND cancel_requested
           AND lease_until_ms <= (SELECT now_ms FROM clock)
         RETURNING kind, status",
    )
    .fetch_all(&mut *connection)
    .await?;
    let failed: Vec<EndedRow> = sqlx::query_as(
        "UPDATE jobs
         SET status = 'failed', lease_until_ms = NULL,
             finished_at_ms = (SELECT now_ms FROM clock),
             failure = json_object(
                 'reason', 'gave up after ' || (attempt - handed_back) || ' attempts: each time '
                     || 'the worker stopped without a word, as a process does that is killed '
                     || 'or runs out of memory',
                 'reference', NULL)
         WHERE status = 'running' AND attempt - handed_back >= ?1
           AND lease_until_ms <= (SELECT now_ms FROM clock)
         RETURNING kind, status",
    )
    .bind(MAX_ATTEMPTS)
    .fetch_all(&mut *connection)
    .await?;
    ended.extend(failed);
    let requeued = sqlx::query(
        "UPDATE jobs SET status = 'queued', lease_until_ms = NULL, progress = NULL
         WHERE status = 'running' AND lease_until_ms <= (SELECT now_ms FROM clock)",
    )
    .execute(connection)
    .await?;
    Ok(Recovered { requeued: requeued.rows_affected(), ended })
}

pub(super) async fn state(pool: &SqlitePool) -> sqlx::Result<QueueState> {
    sqlx::query_as(
        "SELECT (SELECT count(*) FROM jobs WHERE status = 'queued') AS queued,
                (SELECT count(*) FROM jobs WHERE status = 'running') AS running,
                COALESCE((SELECT max(0, (SELECT now_ms FROM clock) - created_at_ms) FROM jobs
                          WHERE status = 'queued' ORDER BY id LIMIT 1), 0) AS oldest_wait_ms",
    )
    .fetch_one(pool)
    .await
}

pub(super) fn millis(duration: Duration) -> i64 {
    i64::try_from(duration.as_millis()).unwrap_or(i64::MAX)
}
