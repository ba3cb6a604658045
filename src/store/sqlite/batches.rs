//! Batches and their jobs.

use async_trait::async_trait;
use serde_json::json;
use sqlx::SqliteConnection;

use crate::store::{
    BatchRow, Batches, CancelledRows, FailureRow, IdempotencyKey, Inserted, MeasurementRow,
    MemberRow, NewBatchRow, Page, Reach, Standing, Status, StoreError, TallyRow,
};

use super::{Sqlite, idempotency};

#[async_trait]
impl Batches for Sqlite {
    async fn measurements_of(
        &self,
        reach: &Reach,
        ids: &[String],
    ) -> Result<Vec<MeasurementRow>, StoreError> {
        let those = sqlx::query_as(
            "SELECT id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
                    experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
                    omega_max_rad_s, notes, quantities, simulation_s, diagnosis_s,
                    (SELECT json_group_array(name ORDER BY position) FROM measurement_files
                     WHERE measurement_id = measurements.id) AS files
             FROM measurements
             WHERE id IN (SELECT value FROM json_each(?1)) AND (?2 IS NULL OR owner = ?2)",
        );
        let those = those.bind(json!(ids).to_string()).bind(reach.read());
        Ok(those.fetch_all(&self.readers).await?)
    }

    async fn insert_batch(
        &self,
        reach: &Reach,
        row: &NewBatchRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        // Written out before anybody waits for the lock.
        let jobs = row.jobs.iter();
        let jobs = jobs.map(|job| json!([job.job_id, job.measurement_id, job.request, job.file]));
        let jobs = serde_json::Value::Array(jobs.collect()).to_string();
        let mut transaction = self.begin().await?;
        let written = insert(&mut transaction, reach, row, &jobs, key).await;
        self.end(transaction, written).await
    }

    async fn batch(&self, reach: &Reach, id: &str) -> Result<Option<BatchRow>, StoreError> {
        let one = sqlx::query_as(
            "SELECT id, created_at_ms, name, kind, request, jobs FROM batches
             WHERE id = ?1 AND (?2 IS NULL OR owner = ?2)",
        );
        Ok(one.bind(id).bind(reach.read()).fetch_optional(&self.readers).await?)
    }

    async fn batches(&self, reach: &Reach, page: &Page) -> Result<Vec<BatchRow>, StoreError> {
        let newest = sqlx::query_as(
            "SELECT id, created_at_ms, name, kind, request, jobs FROM batches
             WHERE (?1 IS NULL OR id < ?1) AND (?3 IS NULL OR owner = ?3)
             ORDER BY id DESC LIMIT ?2",
        );
        let newest = newest.bind(&page.before).bind(page.limit).bind(reach.read());
        Ok(newest.fetch_all(&self.readers).await?)
    }

    async fn batch_tallies(
        &self,
        reach: &Reach,
        ids: &[String],
    ) -> Result<Vec<TallyRow>, StoreError> {
        let tallies = sqlx::query_as(
            "SELECT batch_id, status, verdict, cause, count(*) AS jobs,
                    min(started_at_ms) AS started_ms, max(finished_at_ms) AS finished_ms
             FROM jobs
             WHERE batch_id IN (SELECT id FROM batches
                                WHERE id IN (SELECT value FROM json_each(?1))
                                  AND (?2 IS NULL OR owner = ?2))
             GROUP BY batch_id, status, verdict, cause",
        );
        let tallies = tallies.bind(json!(ids).to_string()).bind(reach.read());
        Ok(tallies.fetch_all(&self.readers).await?)
    }

    async fn batch_failures(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Vec<FailureRow>, StoreError> {
        let reasons = sqlx::query_as(
            "SELECT failure ->> '$.reason' AS reason, count(*) AS jobs FROM jobs
             WHERE batch_id = ?1 AND status = 'failed' AND failure ->> '$.reason' IS NOT NULL
               AND (?2 IS NULL OR owner = ?2)
             GROUP BY reason ORDER BY jobs DESC, reason LIMIT ?3",
        );
        let reasons = reasons.bind(id).bind(reach.read()).bind(limit);
        Ok(reasons.fetch_all(&self.readers).await?)
    }

    async fn batch_members(
        &self,
        reach: &Reach,
        id: &str,
        standing: Option<Standing>,
        after: Option<&str>,
        limit: u32,
    ) -> Result<Vec<MemberRow>, StoreError> {
        let members = sqlx::query_as(
            "SELECT member.measurement_id, member.file, member.job_id, status, verdict, cause,
                    confidence, failure
             FROM batch_members AS member LEFT JOIN jobs ON jobs.id = member.job_id
             WHERE member.batch_id = (SELECT id FROM batches
                                      WHERE id = ?1 AND (?2 IS NULL OR owner = ?2))
               AND (?3 IS NULL OR member.job_id > ?3)
               AND (?4 IS NULL OR COALESCE(status, 'deleted') = ?4)
             ORDER BY member.job_id LIMIT ?5",
        );
        let members = members.bind(id).bind(reach.read()).bind(after);
        let members = members.bind(standing.map(Standing::name)).bind(limit);
        Ok(members.fetch_all(&self.readers).await?)
    }

    async fn cancel_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<CancelledRows>, StoreError> {
        let mut transaction = self.begin().await?;
        let cancelled = cancel(&mut transaction, reach, id, limit).await;
        self.end(transaction, cancelled).await
    }

    async fn delete_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<u64>, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = delete(&mut transaction, reach, id, limit).await;
        self.end(transaction, deleted).await
    }
}

/// `jobs`: JSON array of id, measurement, request and file of each.
async fn insert(
    connection: &mut SqliteConnection,
    reach: &Reach,
    row: &NewBatchRow,
    jobs: &str,
    key: Option<&IdempotencyKey>,
) -> sqlx::Result<Inserted> {
    let claim = idempotency::claim(connection, reach, "batch", key, &row.id).await?;
    if claim != Inserted::Created {
        return Ok(claim);
    }
    sqlx::query(
        "INSERT INTO batches (id, created_at_ms, owner, name, kind, request, jobs)
         VALUES (?1, (SELECT now_ms FROM clock), ?2, ?3, ?4, ?5, ?6)",
    )
    .bind(&row.id)
    .bind(&reach.owner)
    .bind(&row.name)
    .bind(&row.kind)
    .bind(&row.request)
    .bind(row.jobs.len() as i64)
    .execute(&mut *connection)
    .await?;
    // The turns are those that the jobs would have if they came one by one.
    let turn: i64 = sqlx::query_scalar(
        "SELECT max(COALESCE((SELECT min(turn) FROM jobs WHERE status = 'queued'), 0),
                    COALESCE((SELECT max(turn) + 1 FROM jobs
                              WHERE status = 'queued' AND submitter = ?1), 0))",
    )
    .bind(&row.submitter)
    .fetch_one(&mut *connection)
    .await?;
    sqlx::query(
        "INSERT INTO jobs (id, measurement_id, kind, request, submitter, status, created_at_ms,
                           turn, owner, batch_id, priority)
         SELECT value ->> 0, value ->> 1, ?2, value ->> 2, ?3, 'queued', now_ms, ?4 + key, ?5, ?6,
                ?7
         FROM json_each(?1), clock",
    )
    .bind(jobs)
    .bind(&row.kind)
    .bind(&row.submitter)
    .bind(turn)
    .bind(&reach.owner)
    .bind(&row.id)
    .bind(row.priority.rank())
    .execute(&mut *connection)
    .await?;
    sqlx::query(
        "INSERT INTO batch_members (batch_id, job_id, measurement_id, file)
         SELECT ?2, value ->> 0, value ->> 1, value ->> 3 FROM json_each(?1)",
    )
    .bind(jobs)
    .bind(&row.id)
    .execute(connection)
    .await?;
    Ok(claim)
}

async fn cancel(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
    limit: u32,
) -> sqlx::Result<Option<CancelledRows>> {
    if !may_change(connection, reach, id).await? {
        return Ok(None);
    }
    let left: Vec<Status> = sqlx::query_scalar(
        "UPDATE jobs
         SET cancel_requested = 1,
             status = CASE status WHEN 'queued' THEN 'cancelled' ELSE status END,
             finished_at_ms = CASE status WHEN 'queued' THEN (SELECT now_ms FROM clock) END
         WHERE id IN (SELECT id FROM jobs
                      WHERE batch_id = ?1 AND status IN ('queued', 'running')
                        AND NOT cancel_requested
                      LIMIT ?2)
         RETURNING status",
    )
    .bind(id)
    .bind(limit)
    .fetch_all(connection)
    .await?;
    Ok(Some(CancelledRows::of(&left)))
}

async fn delete(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
    limit: u32,
) -> sqlx::Result<Option<u64>> {
    if !may_change(connection, reach, id).await? {
        return Ok(None);
    }
    let removed = sqlx::query(
        "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs WHERE batch_id = ?1 LIMIT ?2)",
    );
    let removed = removed.bind(id).bind(limit).execute(&mut *connection).await?.rows_affected();
    if removed < u64::from(limit) {
        let keys = sqlx::query("DELETE FROM idempotency_keys WHERE resource_id = ?1").bind(id);
        keys.execute(&mut *connection).await?;
        sqlx::query("DELETE FROM batches WHERE id = ?1").bind(id).execute(connection).await?;
    }
    Ok(Some(removed))
}

async fn may_change(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<bool> {
    let within = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM batches WHERE id = ?1 AND (?2 IS NULL OR owner = ?2))",
    );
    within.bind(id).bind(reach.changed()).fetch_one(connection).await
}
