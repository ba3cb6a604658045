//! Batches and their jobs.

use async_trait::async_trait;
use sqlx::PgConnection;

use crate::store::{
    BatchRow, Batches, CancelledRows, FailureRow, IdempotencyKey, Inserted, MeasurementRow,
    MemberRow, NewBatchRow, Page, Reach, Standing, Status, StoreError, TallyRow, Wake,
};

use super::{Engine, idempotency, locks};

#[async_trait]
impl Batches for Engine {
    async fn measurements_of(
        &self,
        reach: &Reach,
        ids: &[String],
    ) -> Result<Vec<MeasurementRow>, StoreError> {
        let those = sqlx::query_as(
            "SELECT id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
                    experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
                    omega_max_rad_s, notes, quantities, simulation_s, diagnosis_s,
                    (SELECT '[' || coalesce(string_agg(to_json(name)::text, ',' ORDER BY position),
                                            '') || ']'
                     FROM measurement_files WHERE measurement_id = measurements.id) AS files
             FROM measurements
             WHERE id = ANY($1) AND ($2 IS NULL OR owner = $2)",
        );
        let those = those.bind(ids).bind(reach.read());
        Ok(those.fetch_all(&self.pool).await?)
    }

    async fn insert_batch(
        &self,
        reach: &Reach,
        row: &NewBatchRow,
        key: Option<&IdempotencyKey>,
    ) -> Result<Inserted, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let written = insert(&mut transaction, reach, row, key).await?;
        transaction.commit().await?;
        if written == Inserted::Created {
            self.speaker.say(&[Wake::Queued]);
        }
        Ok(written)
    }

    async fn batch(&self, reach: &Reach, id: &str) -> Result<Option<BatchRow>, StoreError> {
        let one = sqlx::query_as(
            "SELECT id, created_at_ms, name, kind, request, jobs FROM batches
             WHERE id = $1 AND ($2 IS NULL OR owner = $2)",
        );
        Ok(one.bind(id).bind(reach.read()).fetch_optional(&self.pool).await?)
    }

    async fn batches(&self, reach: &Reach, page: &Page) -> Result<Vec<BatchRow>, StoreError> {
        let newest = sqlx::query_as(
            "SELECT id, created_at_ms, name, kind, request, jobs FROM batches
             WHERE ($1 IS NULL OR id < $1) AND ($3 IS NULL OR owner = $3)
             ORDER BY id DESC LIMIT $2",
        );
        let newest = newest.bind(&page.before).bind(i64::from(page.limit)).bind(reach.read());
        Ok(newest.fetch_all(&self.pool).await?)
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
                                WHERE id = ANY($1)
                                  AND ($2 IS NULL OR owner = $2))
             GROUP BY batch_id, status, verdict, cause",
        );
        let tallies = tallies.bind(ids).bind(reach.read());
        Ok(tallies.fetch_all(&self.pool).await?)
    }

    async fn batch_failures(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Vec<FailureRow>, StoreError> {
        let reasons = sqlx::query_as(
            "SELECT failure::json ->> 'reason' AS reason, count(*) AS jobs FROM jobs
             WHERE batch_id = $1 AND status = 'failed' AND failure::json ->> 'reason' IS NOT NULL
               AND ($2 IS NULL OR owner = $2)
             GROUP BY 1 ORDER BY 2 DESC, 1 LIMIT $3",
        );
        let reasons = reasons.bind(id).bind(reach.read()).bind(i64::from(limit));
        Ok(reasons.fetch_all(&self.pool).await?)
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
                                      WHERE id = $1 AND ($2 IS NULL OR owner = $2))
               AND ($3 IS NULL OR member.job_id > $3)
               AND ($4 IS NULL OR COALESCE(status, 'deleted') = $4)
             ORDER BY member.job_id LIMIT $5",
        );
        let members = members.bind(id).bind(reach.read()).bind(after);
        let members = members.bind(standing.map(Standing::name)).bind(i64::from(limit));
        Ok(members.fetch_all(&self.pool).await?)
    }

    async fn cancel_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<CancelledRows>, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let cancelled = cancel(&mut transaction, reach, id, limit).await?;
        transaction.commit().await?;
        if cancelled.is_some() {
            self.speaker.say(&[Wake::Unwanted, Wake::Changed, Wake::Ended]);
        }
        Ok(cancelled)
    }

    async fn delete_batch(
        &self,
        reach: &Reach,
        id: &str,
        limit: u32,
    ) -> Result<Option<u64>, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let deleted = delete(&mut transaction, reach, id, limit).await?;
        transaction.commit().await?;
        if deleted.is_some() {
            self.speaker.say(&[Wake::Unwanted, Wake::Ended]);
        }
        Ok(deleted)
    }
}

async fn insert(
    connection: &mut PgConnection,
    reach: &Reach,
    row: &NewBatchRow,
    key: Option<&IdempotencyKey>,
) -> sqlx::Result<Inserted> {
    let claim = idempotency::claim(connection, reach, "batch", key, &row.id).await?;
    if claim != Inserted::Created {
        return Ok(claim);
    }
    sqlx::query(
        "INSERT INTO batches (id, created_at_ms, owner, name, kind, request, jobs)
         VALUES ($1, (SELECT now_ms FROM clock), $2, $3, $4, $5, $6)",
    )
    .bind(&row.id)
    .bind(&reach.owner)
    .bind(&row.name)
    .bind(&row.kind)
    .bind(&row.request)
    .bind(row.jobs.len() as i64)
    .execute(&mut *connection)
    .await?;
    // Two jobs of one submitter must not take the same turn.
    locks::wait_for(connection, locks::SUBMITTER, &row.submitter).await?;
    // The turns are those that the jobs would have if they came one by one.
    let turn: i64 = sqlx::query_scalar(
        "SELECT greatest(last_value + 1,
                         COALESCE((SELECT max(turn) + 1 FROM queue
                                   WHERE NOT running AND turn >= last_value
                                     AND submitter = $1), 0))
         FROM lowest_turn",
    )
    .bind(&row.submitter)
    .fetch_one(&mut *connection)
    .await?;
    let all = || row.jobs.iter();
    let ids: Vec<&str> = all().map(|job| job.job_id.as_str()).collect();
    let measurements: Vec<&str> = all().map(|job| job.measurement_id.as_str()).collect();
    sqlx::query(
        "INSERT INTO jobs (id, measurement_id, kind, request, submitter, status, created_at_ms,
                           turn, owner, batch_id, priority)
         SELECT id, measurement_id, $4, request, $5, 'queued', now_ms, $6 + place - 1, $7, $8, $9
         FROM unnest($1::text[], $2::text[], $3::text[]) WITH ORDINALITY
                  AS job (id, measurement_id, request, place), clock",
    )
    .bind(&ids)
    .bind(&measurements)
    .bind(all().map(|job| job.request.as_str()).collect::<Vec<_>>())
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
         SELECT $4, * FROM unnest($1::text[], $2::text[], $3::text[])",
    )
    .bind(&ids)
    .bind(&measurements)
    .bind(all().map(|job| job.file.as_deref()).collect::<Vec<_>>())
    .bind(&row.id)
    .execute(connection)
    .await?;
    Ok(claim)
}

async fn cancel(
    connection: &mut PgConnection,
    reach: &Reach,
    id: &str,
    limit: u32,
) -> sqlx::Result<Option<CancelledRows>> {
    if !may_change(connection, reach, id).await? {
        return Ok(None);
    }
    let left: Vec<Status> = sqlx::query_scalar(
        "UPDATE jobs
         SET cancel_requested = TRUE,
             status = CASE status WHEN 'queued' THEN 'cancelled' ELSE status END,
             finished_at_ms = CASE status WHEN 'queued' THEN (SELECT now_ms FROM clock) END
         WHERE id IN (SELECT id FROM jobs
                      WHERE batch_id = $1 AND status IN ('queued', 'running')
                        AND NOT cancel_requested
                      ORDER BY id LIMIT $2 FOR UPDATE)
         RETURNING status",
    )
    .bind(id)
    .bind(i64::from(limit))
    .fetch_all(connection)
    .await?;
    Ok(Some(CancelledRows::of(&left)))
}

async fn delete(
    connection: &mut PgConnection,
    reach: &Reach,
    id: &str,
    limit: u32,
) -> sqlx::Result<Option<u64>> {
    if !may_change(connection, reach, id).await? {
        return Ok(None);
    }
    let removed = sqlx::query(
        "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs WHERE batch_id = $1
                                       ORDER BY id LIMIT $2 FOR UPDATE)",
    );
    let removed = removed.bind(id).bind(i64::from(limit)).execute(&mut *connection).await?;
    if removed.rows_affected() < u64::from(limit) {
        let keys = sqlx::query("DELETE FROM idempotency_keys WHERE resource_id = $1").bind(id);
        keys.execute(&mut *connection).await?;
        sqlx::query("DELETE FROM batches WHERE id = $1").bind(id).execute(connection).await?;
    }
    Ok(Some(removed.rows_affected()))
}

async fn may_change(connection: &mut PgConnection, reach: &Reach, id: &str) -> sqlx::Result<bool> {
    let within = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM batches WHERE id = $1 AND ($2 IS NULL OR owner = $2))",
    );
    within.bind(id).bind(reach.changed()).fetch_one(connection).await
}
