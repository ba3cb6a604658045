//! What becomes of jobs whose worker stopped without a word.

use std::time::Duration;

use sqlx::SqliteConnection;

use crate::store::queue::gave_up;
use crate::store::{EndedRow, LONGEST_WAIT, MAX_ATTEMPTS, Recovered};

use crate::store::decode::millis;

use super::boot;

/// Requeues jobs whose lease has expired, or ends them, by the rule of [`crate::store`].
pub(super) async fn recover_expired(
    connection: &mut SqliteConnection,
    wait: Duration,
) -> sqlx::Result<Recovered> {
    let mut recovered = Recovered::default();
    for (id, alone) in judged(connection).await? {
        let left: EndedRow = sqlx::query_as(
            "UPDATE jobs
             SET charged = charged + ?2, shared = shared + (NOT ?2), lease_until_ms = NULL,
                 status = CASE WHEN cancel_requested THEN 'cancelled'
                               WHEN charged + ?2 >= ?3 THEN 'failed' ELSE 'queued' END,
                 progress = CASE WHEN cancel_requested OR charged + ?2 >= ?3 THEN progress END,
                 finished_at_ms = CASE WHEN cancel_requested OR charged + ?2 >= ?3
                                       THEN (SELECT now_ms FROM clock) END,
                 failure = CASE WHEN NOT cancel_requested AND charged + ?2 >= ?3 THEN ?6 END,
                 due_ms = (SELECT now_ms FROM clock) + CASE charged + shared WHEN 0 THEN 0
                     ELSE min(?4 << min(2 * (charged + shared - 1), 20), max(?4, ?5)) END
             WHERE id = ?1
             RETURNING kind, status",
        )
        .bind(id)
        .bind(alone)
        .bind(MAX_ATTEMPTS)
        .bind(millis(wait))
        .bind(millis(LONGEST_WAIT))
        .bind(gave_up())
        .fetch_one(&mut *connection)
        .await?;
        recovered.count(left);
    }
    Ok(recovered)
}

/// The jobs whose lease has expired and of which it is known what became of their siblings, the
/// other jobs in hand of their worker; and whether each is the only one that was lost, by a worker
/// that died by itself.
async fn judged(connection: &mut SqliteConnection) -> sqlx::Result<Vec<(String, bool)>> {
    // A sibling that was heard of after the lease had expired lives. One that was not, but whose
    // own lease is good for a little longer, must be waited for: it may have died at the same time.
    sqlx::query_as(
        "SELECT id, lives OR (here AND NOT siblings)
         FROM (SELECT id,
                      substr(worker, 1, length(?1)) = ?1 OR instr(worker, '/') = 0 AS here,
                      EXISTS (SELECT 1 FROM jobs AS sibling
                              WHERE sibling.status = 'running' AND sibling.worker IS jobs.worker
                                AND sibling.id <> jobs.id) AS siblings,
                      EXISTS (SELECT 1 FROM jobs AS sibling
                              WHERE sibling.status = 'running' AND sibling.worker IS jobs.worker
                                AND sibling.renewed_at_ms > jobs.lease_until_ms) AS lives,
                      EXISTS (SELECT 1 FROM jobs AS sibling
                              WHERE sibling.status = 'running' AND sibling.worker IS jobs.worker
                                AND sibling.lease_until_ms > (SELECT now_ms FROM clock)) AS open
               FROM jobs
               WHERE status = 'running' AND lease_until_ms <= (SELECT now_ms FROM clock))
         WHERE lives OR NOT open
         ORDER BY id",
    )
    .bind(boot::prefix())
    .fetch_all(connection)
    .await
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sqlx::sqlite::SqlitePoolOptions;

    use super::*;
    use crate::store::ALONE_AFTER;
    use crate::store::sqlite::{migrations, queue};

    #[tokio::test]
    async fn a_suspect_runs_alone_at_first_and_longer_after_each_further_death() {
        let pool = SqlitePoolOptions::new().max_connections(1);
        let pool = pool.connect("sqlite::memory:").await.unwrap();
        migrations::run(&pool).await.unwrap();
        sqlx::raw_sql(
            "PRAGMA foreign_keys = OFF;
             INSERT INTO jobs (id, measurement_id, kind, request, status, created_at_ms, turn)
             VALUES ('suspect', 'm', 'identify', '{}', 'queued', 0, 1),
                    ('other', 'm', 'identify', '{}', 'queued', 0, 2)",
        )
        .execute(&pool)
        .await
        .unwrap();
        let mut connection = pool.acquire().await.unwrap();
        let worker = boot::worker("worker");
        // Seconds that a suspect of so many deaths has run, and whether another job begins then.
        for (shared, seconds, begins) in [
            (ALONE_AFTER - 1, 0, true),
            (ALONE_AFTER, 14, false),
            (ALONE_AFTER, 16, true),
            (ALONE_AFTER + 1, 58, false),
            (ALONE_AFTER + 1, 62, true),
            (ALONE_AFTER + 50, 3600, false),
        ] {
            sqlx::query(
                "UPDATE jobs SET status = 'running', worker = ?1, shared = ?2,
                     lease_until_ms = (SELECT now_ms FROM clock) + 60000,
                     started_at_ms = (SELECT now_ms FROM clock) - 1000 * ?3
                 WHERE id = 'suspect'",
            )
            .bind(&worker)
            .bind(shared)
            .bind(seconds)
            .execute(&mut *connection)
            .await
            .unwrap();
            sqlx::query("UPDATE jobs SET status = 'queued', worker = NULL WHERE id = 'other'")
                .execute(&mut *connection)
                .await
                .unwrap();
            let next = queue::lease(&mut connection, "worker", Duration::from_secs(60)).await;
            assert_eq!(next.unwrap().is_some(), begins, "{shared} {seconds}");
        }
    }

    #[tokio::test]
    async fn a_job_that_was_alone_is_charged_unless_the_machine_has_restarted() {
        let pool = SqlitePoolOptions::new().max_connections(1);
        let pool = pool.connect("sqlite::memory:").await.unwrap();
        migrations::run(&pool).await.unwrap();
        sqlx::raw_sql(
            "PRAGMA foreign_keys = OFF;
             INSERT INTO jobs (id, measurement_id, kind, request, status, created_at_ms)
             VALUES ('a', 'm', 'identify', '{}', 'queued', 0)",
        )
        .execute(&pool)
        .await
        .unwrap();
        let mut connection = pool.acquire().await.unwrap();
        let mut dies = async |worker: String| {
            sqlx::query("UPDATE jobs SET status = 'running', worker = ?1, lease_until_ms = 1")
                .bind(worker)
                .execute(&mut *connection)
                .await
                .unwrap();
            let recovered = recover_expired(&mut connection, Duration::ZERO).await.unwrap();
            (recovered.requeued, recovered.ended.len())
        };
        for _ in 0..2 * MAX_ATTEMPTS {
            assert_eq!(dies("an-earlier-run/worker".into()).await, (1, 0));
        }
        for _ in 1..MAX_ATTEMPTS {
            assert_eq!(dies(boot::worker("worker")).await, (1, 0));
        }
        assert_eq!(dies(boot::worker("worker")).await, (0, 1));
    }
}
