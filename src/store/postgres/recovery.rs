//! What becomes of jobs whose worker stopped without a word.
//!
//! A lease that was last renewed before Postgres started is good for its whole length once more:
//! meanwhile a worker that lives renews it. Where none does, that proves nothing against the job: the
//! worker may have stopped with the database. Nor does the end of a lease that was last renewed before a
//! standby took over: nobody could renew it while no database took writes.

use std::time::Duration;

use sqlx::PgConnection;

use crate::store::decode::millis;
use crate::store::queue::gave_up;
use crate::store::{EndedRow, LONGEST_WAIT, MAX_ATTEMPTS, Recovered};

use super::locks;

/// Requeues jobs whose lease has expired, or ends them, by the rule of [`crate::store`]. `None`: no
/// lease has expired.
pub(super) async fn recover_expired(
    connection: &mut PgConnection,
    wait: Duration,
) -> sqlx::Result<Option<Recovered>> {
    if !any_expired(connection).await? {
        return Ok(None);
    }
    let mut recovered = Recovered::default();
    let expired = expired(connection).await?;
    for (id, alone) in judged(connection, &expired).await? {
        let left: EndedRow = sqlx::query_as(
            "WITH lost AS (
                 UPDATE jobs
                 SET charged = charged + $2, shared = shared + (1 - $2), lease_until_ms = NULL,
                     status = CASE WHEN cancel_requested THEN 'cancelled'
                                   WHEN charged + $2 >= $3 THEN 'failed' ELSE 'queued' END,
                     progress = CASE WHEN cancel_requested OR charged + $2 >= $3 THEN progress END,
                     finished_at_ms = CASE WHEN cancel_requested OR charged + $2 >= $3
                                           THEN (SELECT now_ms FROM clock) END,
                     failure = CASE WHEN NOT cancel_requested AND charged + $2 >= $3 THEN $6 END,
                     due_ms = (SELECT now_ms FROM clock) + CASE charged + shared WHEN 0 THEN 0
                         ELSE least($4 << least(2 * (charged + shared - 1), 20)::integer,
                                    greatest($4, $5)) END
                 WHERE id = $1
                 RETURNING kind, status, turn)
             SELECT kind, status, setval('lowest_turn', least(turn, last_value))
             FROM lost, lowest_turn",
        )
        .bind(id)
        .bind(i64::from(alone))
        .bind(i64::from(MAX_ATTEMPTS))
        .bind(millis(wait))
        .bind(millis(LONGEST_WAIT))
        .bind(gave_up())
        .fetch_one(&mut *connection)
        .await?;
        recovered.count(left);
    }
    Ok(Some(recovered))
}

/// Whether a lease has expired. Mostly none has, and no lock is needed to know.
async fn any_expired(connection: &mut PgConnection) -> sqlx::Result<bool> {
    sqlx::query_scalar(
        "SELECT EXISTS (
             SELECT 1 FROM queue JOIN jobs ON jobs.id = queue.job_id
             WHERE queue.running
               AND lease_ends_ms(lease_until_ms, renewed_at_ms) <= (SELECT now_ms FROM clock))",
    )
    .fetch_one(connection)
    .await
}

/// The jobs whose lease has expired, held until the transaction ends. One that a heartbeat holds at
/// this moment is left for the next time; nobody looks twice at once.
async fn expired(connection: &mut PgConnection) -> sqlx::Result<Vec<String>> {
    if !locks::recovery(connection).await? {
        return Ok(Vec::new());
    }
    // Whoever ends a lease leaves no time in its row: that of a job which runs no more is passed over.
    sqlx::query_scalar(
        "SELECT jobs.id FROM queue JOIN jobs ON jobs.id = queue.job_id
         WHERE queue.running
           AND lease_ends_ms(lease_until_ms, renewed_at_ms) <= (SELECT now_ms FROM clock)
         ORDER BY jobs.id FOR UPDATE OF jobs SKIP LOCKED",
    )
    .fetch_all(connection)
    .await
}

/// Those of them of which it is known what became of their siblings, the other jobs in hand of
/// their worker; and whether each is the only one that was lost.
async fn judged(
    connection: &mut PgConnection,
    expired: &[String],
) -> sqlx::Result<Vec<(String, bool)>> {
    // A sibling that was heard of after the lease had expired lives. One that was not, but whose
    // own lease is good for a little longer, must be waited for: it may have died at the same time.
    // A lease that is good for longer than it says was last heard of before Postgres started. One that
    // is no younger than the last transaction of another server was last heard of before this one took
    // over; where it never was a standby there is no such transaction.
    sqlx::query_as(
        "SELECT id, (lives OR NOT siblings) AND heard
         FROM (SELECT id,
                      lease_ends_ms(lease_until_ms, renewed_at_ms) = lease_until_ms
                          AND COALESCE(renewed_at_ms > floor(1000 * extract(
                                  epoch FROM pg_last_xact_replay_timestamp())), TRUE) AS heard,
                      EXISTS (SELECT 1 FROM queue AS sibling
                              WHERE sibling.running AND sibling.worker = jobs.worker
                                AND sibling.job_id <> jobs.id) AS siblings,
                      EXISTS (SELECT 1 FROM queue JOIN jobs AS sibling ON sibling.id = job_id
                              WHERE queue.running AND queue.worker = jobs.worker
                                AND sibling.renewed_at_ms > jobs.lease_until_ms) AS lives,
                      EXISTS (SELECT 1 FROM queue JOIN jobs AS sibling ON sibling.id = job_id
                              WHERE queue.running AND queue.worker = jobs.worker
                                AND lease_ends_ms(sibling.lease_until_ms, sibling.renewed_at_ms)
                                    > (SELECT now_ms FROM clock)) AS open
               FROM jobs
               WHERE id = ANY($1)) AS judged
         WHERE lives OR NOT open
         ORDER BY id",
    )
    .bind(expired)
    .fetch_all(connection)
    .await
}
