//! The lease queue: what moves a job from one status to the next.

use std::time::Duration;

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::decode::millis;
use crate::store::gist::Gist;
use crate::store::{
    ALONE_AFTER, ALONE_FOR, Beat, Cancelling, ConvergencePoint, Lease, Outcome, QueueState, Reach,
    Status,
};

use super::{boot, history};

pub(super) async fn lease(
    connection: &mut SqliteConnection,
    worker: &str,
    duration: Duration,
) -> sqlx::Result<Option<Lease>> {
    let Some(next) = next(connection, worker).await? else { return Ok(None) };
    if next.id != next.holder {
        sqlx::query(
            "UPDATE jobs
             SET turn = (SELECT turn FROM jobs WHERE id = ?1), priority = priority | 1
             WHERE id = ?2",
        )
        .bind(&next.id)
        .bind(&next.holder)
        .execute(&mut *connection)
        .await?;
    }
    sqlx::query_as(
        "UPDATE jobs
         SET status = 'running', attempt = attempt + 1, progress = NULL, worker = ?1,
             started_at_ms = (SELECT now_ms FROM clock),
             renewed_at_ms = (SELECT now_ms FROM clock),
             lease_until_ms = (SELECT now_ms FROM clock) + ?2, turn = ?4
         WHERE id = ?3
         RETURNING id AS job_id, attempt, measurement_id, kind, request,
                   (SELECT COALESCE(max(seq) + 1, 0) FROM convergence
                    WHERE job_id = jobs.id) AS next_seq",
    )
    .bind(boot::worker(worker))
    .bind(millis(duration))
    .bind(next.id)
    .bind(next.turn)
    .fetch_optional(connection)
    .await
}

/// The job that is leased next.
struct Next {
    id: String,
    /// The job whose turn it is; another one of the same submitter may go before it.
    holder: String,
    turn: i64,
}

async fn next(connection: &mut SqliteConnection, worker: &str) -> sqlx::Result<Option<Next>> {
    // A job that was in hand at several deaths of workers runs alone at first: whatever is next waits.
    let next: Option<(String, String, i64)> = sqlx::query_as(
        "SELECT next.id, holder.id, holder.turn
         FROM (SELECT id, turn, submitter, priority FROM jobs
               WHERE status = 'queued' AND due_ms <= (SELECT now_ms FROM clock)
               ORDER BY turn, id LIMIT 1) AS holder
         JOIN jobs AS next ON next.id = COALESCE(
             (SELECT id FROM jobs
              WHERE status = 'queued' AND due_ms <= (SELECT now_ms FROM clock)
                AND submitter = holder.submitter AND priority >= (holder.priority | 1)
              ORDER BY priority DESC, created_at_ms, id LIMIT 1), holder.id)
         WHERE NOT EXISTS (SELECT 1 FROM jobs AS held
                           WHERE held.status = 'running' AND held.worker = ?1
                             AND (next.shared >= ?2
                                  OR (held.shared >= ?2
                                      AND (SELECT now_ms FROM clock) - held.started_at_ms
                                          < ?3 << min(2 * (held.shared - ?2), 20))))",
    )
    .bind(boot::worker(worker))
    .bind(ALONE_AFTER)
    .bind(millis(ALONE_FOR))
    .fetch_optional(connection)
    .await?;
    Ok(next.map(|(id, holder, turn)| Next { id, holder, turn }))
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
         SET lease_until_ms = (SELECT now_ms FROM clock) + ?3,
             renewed_at_ms = (SELECT now_ms FROM clock), progress = COALESCE(?4, progress)
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
    let (result, failure) = outcome.columns();
    let Gist { verdict, cause, confidence } = outcome.gist();
    let done = sqlx::query(
        "UPDATE jobs
         SET status = ?3, result = ?4, failure = ?5, lease_until_ms = NULL,
             verdict = ?6, cause = ?7, confidence = ?8,
             finished_at_ms = (SELECT now_ms FROM clock)
         WHERE id = ?1 AND attempt = ?2 AND status = 'running'
           AND lease_until_ms > (SELECT now_ms FROM clock)",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .bind(outcome.status())
    .bind(result)
    .bind(failure)
    .bind(verdict)
    .bind(cause)
    .bind(confidence)
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
