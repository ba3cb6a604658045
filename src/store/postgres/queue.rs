//! The lease queue: what moves a job from one status to the next.
//!
//! A transaction of another process may hold a row of the queue at any time. Whoever takes a job
//! passes over such rows; every other write waits for the row and then looks again whether it still
//! applies, so that of two writes that exclude each other one finds the other's.
//!
//! Jobs are looked for from the lowest turn on, a sequence: taking a job raises it, and putting one
//! back lowers it. Several processes do so at once, jobs exchange turns meanwhile, and a job that waited
//! for its time is below it; so every process looks at the whole queue once a second, and sets the
//! lowest turn to what it finds.
//!
//! They are looked for in the table `queue`, which holds no job that has ended and follows `jobs` by
//! triggers. The row of a job in `jobs` decides, and is locked first: that in `queue` is written by
//! whoever holds it, and never locked before.

use std::time::Duration;

use sqlx::{PgConnection, PgPool};

use crate::store::decode::millis;
use crate::store::gist::Gist;
use crate::store::{
    ALONE_AFTER, ALONE_FOR, Beat, Cancelling, ConvergencePoint, Lease, Outcome, QueueState, Reach,
    Status,
};

use super::history;

/// Leases the next job: of the whole queue, or of what is not below the lowest turn.
pub(super) async fn lease(
    pool: &PgPool,
    worker: &str,
    duration: Duration,
    whole: bool,
) -> sqlx::Result<Option<Lease>> {
    // A number in the text lets an index be used, of jobs that share three deaths or more.
    const { assert!(ALONE_AFTER == 3) };
    // A job that was in hand at several deaths of workers runs alone at first: whatever is next waits.
    // Jobs are locked one by one in the order of the queue, until one is held and still waits. Others
    // never hold as many as the limits say, which let the first be read without sorting all.
    sqlx::query_as(
        "WITH holder AS MATERIALIZED (
             SELECT job.id, job.submitter, job.priority, job.shared, job.turn
             FROM (SELECT job_id, turn FROM queue
                   WHERE NOT running AND due_ms <= (SELECT now_ms FROM clock)
                     AND turn >= CASE WHEN $3 THEN 0 ELSE (SELECT last_value FROM lowest_turn) END
                   ORDER BY turn, job_id LIMIT 10000) AS waiting
             CROSS JOIN LATERAL (
                 SELECT id, submitter, priority, shared, turn FROM jobs
                 WHERE id = waiting.job_id AND status = 'queued' AND turn = waiting.turn
                   AND due_ms <= (SELECT now_ms FROM clock)
                 FOR UPDATE SKIP LOCKED) AS job
             LIMIT 1),
         ahead AS MATERIALIZED (
             SELECT job.id, job.shared, job.turn
             FROM (SELECT job_id FROM queue
                   WHERE running::integer = 0 AND due_ms <= (SELECT now_ms FROM clock)
                     AND submitter = (SELECT submitter FROM holder)
                     AND priority >= (SELECT priority | 1 FROM holder)
                   ORDER BY priority DESC, created_at_ms, job_id LIMIT 10000) AS waiting
             CROSS JOIN LATERAL (
                 SELECT id, shared, turn FROM jobs
                 WHERE id = waiting.job_id AND status = 'queued'
                   AND due_ms <= (SELECT now_ms FROM clock)
                 FOR UPDATE SKIP LOCKED) AS job
             LIMIT 1),
         next AS MATERIALIZED (
             SELECT COALESCE(ahead.id, holder.id) AS id, holder.turn,
                    COALESCE(ahead.shared, holder.shared) AS shared
             FROM holder LEFT JOIN ahead ON TRUE),
         taken AS (
             UPDATE jobs
             SET status = 'running', attempt = attempt + 1, progress = NULL, worker = $1,
                 started_at_ms = now_ms, renewed_at_ms = now_ms, lease_until_ms = now_ms + $2,
                 turn = next.turn
             FROM next, clock
             WHERE jobs.id = next.id
               AND NOT EXISTS (SELECT 1 FROM queue AS held
                               WHERE held.running::integer = 1 AND held.worker = $1
                                 AND held.shared >= 3
                                 AND now_ms - held.started_at_ms
                                     < $4 << least(2 * (held.shared - 3), 20)::integer)
               AND (next.shared < 3
                    OR NOT EXISTS (SELECT 1 FROM queue AS held
                                   WHERE held.running AND held.worker = $1))
               AND setval('lowest_turn', CASE WHEN $3 THEN next.turn ELSE greatest(
                       next.turn, (SELECT last_value FROM lowest_turn)) END) IS NOT NULL
             RETURNING jobs.id, attempt, measurement_id, kind, request),
         moved AS (
             UPDATE jobs SET turn = ahead.turn, priority = jobs.priority | 1
             FROM holder, ahead, taken
             WHERE jobs.id = holder.id AND ahead.id <> holder.id AND taken.id = ahead.id)
         SELECT taken.id AS job_id, attempt, measurement_id, kind, request,
                   (SELECT COALESCE(max(seq) + 1, 0) FROM convergence
                    WHERE job_id = taken.id) AS next_seq
         FROM taken",
    )
    .bind(worker)
    .bind(millis(duration))
    .bind(whole)
    .bind(millis(ALONE_FOR))
    .fetch_optional(pool)
    .await
}

pub(super) async fn renew(
    connection: &mut PgConnection,
    lease: &Lease,
    duration: Duration,
    progress: Option<&str>,
    rows: &[ConvergencePoint],
) -> sqlx::Result<Beat> {
    let cancel_requested: Option<bool> = sqlx::query_scalar(
        "UPDATE jobs
         SET lease_until_ms = (SELECT now_ms FROM clock) + $3,
             renewed_at_ms = (SELECT now_ms FROM clock), progress = COALESCE($4, progress)
         WHERE id = $1 AND attempt = $2 AND status = 'running'
           AND lease_ends_ms(lease_until_ms, renewed_at_ms) > (SELECT now_ms FROM clock)
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

pub(super) async fn finish(pool: &PgPool, lease: &Lease, outcome: &Outcome) -> sqlx::Result<bool> {
    let (result, failure) = outcome.columns();
    let Gist { verdict, cause, confidence } = outcome.gist();
    let done = sqlx::query(
        "UPDATE jobs
         SET status = $3, result = $4, failure = $5, lease_until_ms = NULL,
             verdict = $6, cause = $7, confidence = $8,
             finished_at_ms = (SELECT now_ms FROM clock)
         WHERE id = $1 AND attempt = $2 AND status = 'running'
           AND lease_ends_ms(lease_until_ms, renewed_at_ms) > (SELECT now_ms FROM clock)",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .bind(outcome.status())
    .bind(result)
    .bind(failure)
    .bind(verdict)
    .bind(cause)
    .bind(confidence)
    .execute(pool)
    .await?;
    Ok(done.rows_affected() == 1)
}

pub(super) async fn hand_back(pool: &PgPool, lease: &Lease) -> sqlx::Result<bool> {
    let done = sqlx::query(
        "WITH back AS (
             UPDATE jobs
             SET status = CASE WHEN cancel_requested THEN 'cancelled' ELSE 'queued' END,
                 finished_at_ms =
                     CASE WHEN cancel_requested THEN (SELECT now_ms FROM clock) ELSE NULL END,
                 handed_back = handed_back + 1, lease_until_ms = NULL, progress = NULL
             WHERE id = $1 AND attempt = $2 AND status = 'running'
               AND lease_ends_ms(lease_until_ms, renewed_at_ms) > (SELECT now_ms FROM clock)
             RETURNING turn)
         SELECT setval('lowest_turn', least(turn, last_value)) FROM back, lowest_turn",
    )
    .bind(&lease.job_id)
    .bind(lease.attempt)
    .fetch_optional(pool)
    .await?;
    Ok(done.is_some())
}

pub(super) async fn cancel(
    connection: &mut PgConnection,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Cancelling> {
    let status: Option<Status> = sqlx::query_scalar(
        "SELECT status FROM jobs WHERE id = $1 AND ($2 IS NULL OR owner = $2) FOR UPDATE",
    )
    .bind(id)
    .bind(reach.changed())
    .fetch_optional(&mut *connection)
    .await?;
    let (statement, cancelling) = match status {
        None => return Ok(Cancelling::Unknown),
        Some(Status::Queued) => (
            "UPDATE jobs
             SET status = 'cancelled', cancel_requested = TRUE,
                 finished_at_ms = (SELECT now_ms FROM clock)
             WHERE id = $1",
            Cancelling::Cancelled,
        ),
        Some(Status::Running) => {
            ("UPDATE jobs SET cancel_requested = TRUE WHERE id = $1", Cancelling::Requested)
        }
        Some(status) => return Ok(Cancelling::Ended(status)),
    };
    sqlx::query(statement).bind(id).execute(connection).await?;
    Ok(cancelling)
}

pub(super) async fn state(pool: &PgPool) -> sqlx::Result<QueueState> {
    sqlx::query_as(
        "SELECT queued, (SELECT count(*) FROM queue WHERE running) AS running,
                greatest(0, (SELECT now_ms FROM clock) - oldest_ms) AS oldest_wait_ms
         FROM (SELECT count(*) AS queued, min(created_at_ms) AS oldest_ms
               FROM queue WHERE NOT running) AS waiting",
    )
    .fetch_one(pool)
    .await
}
