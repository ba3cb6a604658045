//! Webhooks, events and deliveries.

use std::time::Duration;

use async_trait::async_trait;
use sqlx::PgConnection;

use crate::store::decode::millis;
use crate::store::outbox::{
    DeliveryRow, DueRow, EventRow, NewDeliveryRow, Outbox, Settled, WebhookRow,
};
use crate::store::{Reach, StoreError};

use super::{Engine, locks};

/// Deliveries that may be tried now. There is one at a time to a receiver: one that is slow
/// holds up nobody else, and one that is fast is told in order.
const DUE: &str = "SELECT id FROM deliveries AS due
     WHERE status = 'waiting' AND due_ms <= (SELECT now_ms FROM clock)
       AND ($1 OR webhook_id IS NOT NULL)
       AND NOT EXISTS (
           SELECT 1 FROM deliveries AS other
           WHERE other.status = 'waiting' AND other.webhook_id IS NOT DISTINCT FROM due.webhook_id
             AND other.lease_until_ms > (SELECT now_ms FROM clock))
     ORDER BY due_ms, id LIMIT 1";

#[async_trait]
impl Outbox for Engine {
    async fn insert_webhook(
        &self,
        reach: &Reach,
        row: &WebhookRow,
        most: u32,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        locks::wait_for(&mut transaction, locks::WEBHOOKS, &reach.owner).await?;
        let done = sqlx::query(
            "INSERT INTO webhooks (id, created_at_ms, url, secret, events, owner)
             SELECT $1, (SELECT now_ms FROM clock), $2, $3, $4, $6
             WHERE (SELECT count(*) FROM webhooks WHERE owner = $6) < $5",
        )
        .bind(&row.id)
        .bind(&row.url)
        .bind(&row.secret)
        .bind(&row.events)
        .bind(i64::from(most))
        .bind(&reach.owner)
        .execute(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(done.rows_affected() == 1)
    }

    async fn webhooks(
        &self,
        reach: &Reach,
        limit: Option<u32>,
    ) -> Result<Vec<WebhookRow>, StoreError> {
        // A limit that is null is none.
        let limit = limit.map(i64::from);
        let all = sqlx::query_as(
            "SELECT id, created_at_ms, url, secret, events, disabled, owner FROM webhooks
             WHERE ($1 IS NULL OR owner = $1) ORDER BY id DESC LIMIT $2",
        );
        Ok(all.bind(reach.read()).bind(limit).fetch_all(&self.pool).await?)
    }

    async fn webhook(&self, reach: &Reach, id: &str) -> Result<Option<WebhookRow>, StoreError> {
        let one = sqlx::query_as(
            "SELECT id, created_at_ms, url, secret, events, disabled, owner FROM webhooks
             WHERE id = $1 AND ($2 IS NULL OR owner = $2)",
        );
        Ok(one.bind(id).bind(reach.read()).fetch_optional(&self.pool).await?)
    }

    async fn delete_webhook(&self, reach: &Reach, id: &str) -> Result<bool, StoreError> {
        let delete =
            sqlx::query("DELETE FROM webhooks WHERE id = $1 AND ($2 IS NULL OR owner = $2)");
        let delete = delete.bind(id).bind(reach.changed());
        Ok(delete.execute(&self.pool).await?.rows_affected() == 1)
    }

    async fn events(&self, limit: u32) -> Result<Vec<EventRow>, StoreError> {
        let oldest = sqlx::query_as::<_, EventRow>(
            "SELECT id, job_id, at_ms FROM events WHERE id >= $2 ORDER BY id LIMIT $1",
        );
        let oldest = oldest.bind(i64::from(limit)).bind(self.events.from());
        let oldest = oldest.fetch_all(&self.pool).await?;
        if let Some(first) = oldest.first() {
            self.events.saw(first.id);
        }
        Ok(oldest)
    }

    async fn announce(&self, event: i64, rows: &[NewDeliveryRow]) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let written = announce(&mut transaction, event, rows).await?;
        transaction.commit().await?;
        Ok(written)
    }

    async fn due(&self, lease: Duration, broker: bool) -> Result<Option<DueRow>, StoreError> {
        // Mostly there is none: looking needs no lock.
        let any = sqlx::query_scalar::<_, String>(DUE).bind(broker);
        if any.fetch_optional(&self.pool).await?.is_none() {
            return Ok(None);
        }
        let mut transaction = self.pool.begin().await?;
        let taken = take(&mut transaction, lease, broker).await?;
        transaction.commit().await?;
        Ok(taken)
    }

    async fn settle(
        &self,
        due: &DueRow,
        settled: &Settled,
        answered: Option<u16>,
        error: Option<&str>,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let written = settle(&mut transaction, due, settled, answered, error).await?;
        transaction.commit().await?;
        Ok(written)
    }

    async fn deliveries(
        &self,
        reach: &Reach,
        webhook: &str,
        limit: u32,
    ) -> Result<Vec<DeliveryRow>, StoreError> {
        let newest = sqlx::query_as(
            "SELECT id, event, status, attempts, created_at_ms, due_ms, ended_at_ms, answered, error
             FROM deliveries
             WHERE webhook_id = $1
               AND ($3 IS NULL OR EXISTS (SELECT 1 FROM webhooks WHERE id = $1 AND owner = $3))
             ORDER BY id DESC LIMIT $2",
        );
        Ok(newest
            .bind(webhook)
            .bind(i64::from(limit))
            .bind(reach.read())
            .fetch_all(&self.pool)
            .await?)
    }

    async fn waiting(&self) -> Result<i64, StoreError> {
        let count = sqlx::query_scalar("SELECT count(*) FROM deliveries WHERE status = 'waiting'");
        Ok(count.fetch_one(&self.pool).await?)
    }

    async fn delete_deliveries(&self, age: Duration, limit: u32) -> Result<u64, StoreError> {
        let delete = sqlx::query(
            "DELETE FROM deliveries WHERE id IN (
                 SELECT id FROM deliveries
                 WHERE created_at_ms < (SELECT now_ms FROM clock) - $1
                 LIMIT $2 FOR UPDATE SKIP LOCKED)",
        );
        let delete = delete.bind(millis(age)).bind(i64::from(limit));
        Ok(delete.execute(&self.pool).await?.rows_affected())
    }
}

async fn announce(
    connection: &mut PgConnection,
    event: i64,
    rows: &[NewDeliveryRow],
) -> sqlx::Result<bool> {
    let delete = sqlx::query("DELETE FROM events WHERE id = $1").bind(event);
    if delete.execute(&mut *connection).await?.rows_affected() == 0 {
        return Ok(false);
    }
    for row in rows {
        // A webhook may be gone, or disabled, since they were written.
        sqlx::query(
            "INSERT INTO deliveries
                 (id, webhook_id, event, topic, body, status, created_at_ms, due_ms)
             SELECT $1, $2, $3, $4, $5, 'waiting', now_ms, now_ms FROM clock
             WHERE $2 IS NULL
                OR EXISTS (SELECT 1 FROM webhooks WHERE id = $2 AND disabled IS NULL)",
        )
        .bind(&row.id)
        .bind(&row.webhook_id)
        .bind(&row.event)
        .bind(&row.topic)
        .bind(&row.body)
        .execute(&mut *connection)
        .await?;
    }
    Ok(true)
}

async fn take(
    connection: &mut PgConnection,
    lease: Duration,
    broker: bool,
) -> sqlx::Result<Option<DueRow>> {
    // Of two that take at once, the second sees what is under way.
    locks::wait_for(connection, locks::MESSAGES, "").await?;
    let id: Option<String> =
        sqlx::query_scalar(DUE).bind(broker).fetch_optional(&mut *connection).await?;
    let Some(id) = id else { return Ok(None) };
    sqlx::query(
        "UPDATE deliveries
         SET attempts = attempts + 1, due_ms = (SELECT now_ms FROM clock) + $2,
             lease_until_ms = (SELECT now_ms FROM clock) + $2
         WHERE id = $1",
    )
    .bind(&id)
    .bind(millis(lease))
    .execute(&mut *connection)
    .await?;
    sqlx::query_as(
        "SELECT deliveries.id, attempts AS attempt, webhook_id, topic, body,
                (SELECT now_ms FROM clock) - deliveries.created_at_ms AS age_ms,
                coalesce(url, '') AS url, coalesce(secret, '') AS secret
         FROM deliveries LEFT JOIN webhooks ON webhooks.id = webhook_id
         WHERE deliveries.id = $1",
    )
    .bind(&id)
    .fetch_optional(connection)
    .await
}

async fn settle(
    connection: &mut PgConnection,
    due: &DueRow,
    settled: &Settled,
    answered: Option<u16>,
    error: Option<&str>,
) -> sqlx::Result<bool> {
    let (status, wait) = settled.columns();
    let done = sqlx::query(
        "UPDATE deliveries
         SET status = $3, answered = $4, error = $5, lease_until_ms = NULL,
             due_ms = coalesce((SELECT now_ms FROM clock) + $6, due_ms),
             ended_at_ms = CASE WHEN $6 IS NULL THEN (SELECT now_ms FROM clock) END
         WHERE id = $1 AND attempts = $2 AND status = 'waiting'",
    )
    .bind(&due.id)
    .bind(i64::from(due.attempt))
    .bind(status)
    .bind(answered.map(i64::from))
    .bind(error)
    .bind(wait)
    .execute(&mut *connection)
    .await?;
    if *settled == Settled::Disabled {
        disable(connection, due.webhook_id.as_deref(), error).await?;
    }
    Ok(done.rows_affected() == 1)
}

async fn disable(
    connection: &mut PgConnection,
    webhook: Option<&str>,
    error: Option<&str>,
) -> sqlx::Result<()> {
    sqlx::query("UPDATE webhooks SET disabled = coalesce($2, '') WHERE id = $1")
        .bind(webhook)
        .bind(error)
        .execute(&mut *connection)
        .await?;
    sqlx::query(
        "UPDATE deliveries
         SET status = 'given_up', error = $2, lease_until_ms = NULL,
             ended_at_ms = (SELECT now_ms FROM clock)
         WHERE webhook_id = $1 AND status = 'waiting'",
    )
    .bind(webhook)
    .bind(error)
    .execute(connection)
    .await?;
    Ok(())
}
