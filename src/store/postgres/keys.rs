//! Keys and sessions.

use std::time::Duration;

use async_trait::async_trait;
use sqlx::PgConnection;

use crate::store::decode::millis;
use crate::store::{KeyRow, Keyring, Millis, StoreError, Usage};

use super::Engine;

#[async_trait]
impl Keyring for Engine {
    async fn insert_key(&self, row: &KeyRow) -> Result<bool, StoreError> {
        let done = sqlx::query(
            "INSERT INTO keys (id, name, scopes, sha256, created_at_ms, expires_at_ms, quotas)
             VALUES ($1, $2, $3, $4, (SELECT now_ms FROM clock), $5, $6)
             ON CONFLICT (id) DO NOTHING",
        )
        .bind(&row.id)
        .bind(&row.name)
        .bind(&row.scopes)
        .bind(&row.sha256)
        .bind(row.expires_at_ms)
        .bind(&row.quotas)
        .execute(&self.pool)
        .await?;
        Ok(done.rows_affected() == 1)
    }

    async fn replace_key(
        &self,
        id: &str,
        sha256: &str,
        expires_at_ms: Option<Millis>,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let update = sqlx::query(
            "UPDATE keys SET sha256 = $2, expires_at_ms = $3,
                 created_at_ms = (SELECT now_ms FROM clock)
             WHERE id = $1 AND revoked_at_ms IS NULL",
        );
        let update = update.bind(id).bind(sha256).bind(expires_at_ms);
        let done = update.execute(&mut *transaction).await?;
        sign_out(&mut transaction, id).await?;
        transaction.commit().await?;
        Ok(done.rows_affected() == 1)
    }

    async fn key(&self, id: &str) -> Result<Option<KeyRow>, StoreError> {
        let one = sqlx::query_as(
            "SELECT id, name, scopes, sha256, created_at_ms, expires_at_ms, revoked_at_ms, used_at_ms,
                    quotas, now_ms
             FROM keys, clock WHERE id = $1",
        );
        Ok(one.bind(id).fetch_optional(&self.pool).await?)
    }

    async fn keys(&self, limit: u32) -> Result<Vec<KeyRow>, StoreError> {
        let newest = sqlx::query_as(
            "SELECT id, name, scopes, sha256, created_at_ms, expires_at_ms, revoked_at_ms, used_at_ms,
                    quotas, now_ms
             FROM keys, clock ORDER BY created_at_ms DESC, id LIMIT $1",
        );
        Ok(newest.bind(i64::from(limit)).fetch_all(&self.pool).await?)
    }

    async fn has_keys(&self) -> Result<bool, StoreError> {
        let any = sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM keys)");
        Ok(any.fetch_one(&self.pool).await?)
    }

    async fn has_valid_key(&self) -> Result<bool, StoreError> {
        let any = sqlx::query_scalar(
            "SELECT EXISTS (SELECT 1 FROM keys, clock
                            WHERE revoked_at_ms IS NULL
                              AND (expires_at_ms IS NULL OR expires_at_ms > now_ms))",
        );
        Ok(any.fetch_one(&self.pool).await?)
    }

    async fn revoke_key(&self, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.pool.begin().await?;
        let revoke = sqlx::query(
            "UPDATE keys SET revoked_at_ms = coalesce(revoked_at_ms, (SELECT now_ms FROM clock))
             WHERE id = $1",
        );
        let done = revoke.bind(id).execute(&mut *transaction).await?;
        sign_out(&mut transaction, id).await?;
        transaction.commit().await?;
        Ok(done.rows_affected() == 1)
    }

    async fn limit_key(&self, id: &str, quotas: &str) -> Result<bool, StoreError> {
        let update = sqlx::query("UPDATE keys SET quotas = $2 WHERE id = $1");
        let done = update.bind(id).bind(quotas).execute(&self.pool).await?;
        Ok(done.rows_affected() == 1)
    }

    async fn key_used(&self, id: &str) -> Result<(), StoreError> {
        let update =
            sqlx::query("UPDATE keys SET used_at_ms = (SELECT now_ms FROM clock) WHERE id = $1");
        update.bind(id).execute(&self.pool).await?;
        Ok(())
    }

    async fn usage(&self, id: &str, last: Duration) -> Result<Usage, StoreError> {
        let one = sqlx::query_as::<_, (i64, i64, i64, i64)>(
            "SELECT (SELECT count(*) FROM measurements WHERE owner = $1),
                    (SELECT COALESCE(sum(octet_length(bytes)), 0)
                     FROM measurement_files JOIN measurements ON id = measurement_id
                     WHERE owner = $1),
                    (SELECT count(*) FROM jobs
                     WHERE owner = $1 AND status IN ('queued', 'running')),
                    (SELECT COALESCE(sum(greatest(0, ended_at_ms
                                                     - greatest(started_at_ms, now_ms - $2))), 0)::bigint
                     FROM runs
                     WHERE owner = $1 AND ended_at_ms > now_ms - $2)
                    + (SELECT COALESCE(sum(greatest(0, least(now_ms, lease_until_ms)
                                                 - greatest(started_at_ms, now_ms - $2))), 0)::bigint
                       FROM jobs
                       WHERE owner = $1 AND status = 'running' AND started_at_ms IS NOT NULL)
             FROM clock",
        );
        let one = one.bind(id).bind(millis(last)).fetch_one(&self.pool).await?;
        let (measurements, bytes, unfinished, computed_ms) = one;
        Ok(Usage { measurements, bytes, unfinished, computed_ms })
    }

    async fn insert_session(
        &self,
        sha256: &str,
        key_id: &str,
        expires_at_ms: Millis,
    ) -> Result<(), StoreError> {
        let ended = "DELETE FROM sessions WHERE expires_at_ms <= (SELECT now_ms FROM clock)";
        sqlx::query(ended).execute(&self.pool).await?;
        let insert = "INSERT INTO sessions (sha256, key_id, expires_at_ms) VALUES ($1, $2, $3)";
        let insert = sqlx::query(insert).bind(sha256).bind(key_id).bind(expires_at_ms);
        insert.execute(&self.pool).await?;
        Ok(())
    }

    async fn end_oldest_sessions(&self, key_id: &str, most: u32) -> Result<(), StoreError> {
        let delete = sqlx::query(
            "DELETE FROM sessions WHERE key_id = $1 AND sha256 NOT IN (
                 SELECT sha256 FROM sessions WHERE key_id = $1
                 ORDER BY expires_at_ms DESC, sha256 LIMIT $2)",
        );
        delete.bind(key_id).bind(i64::from(most)).execute(&self.pool).await?;
        Ok(())
    }

    async fn session(&self, sha256: &str) -> Result<Option<KeyRow>, StoreError> {
        let one = sqlx::query_as(
            "SELECT id, name, scopes, keys.sha256, created_at_ms, keys.expires_at_ms, revoked_at_ms,
                    used_at_ms, quotas, now_ms
             FROM sessions JOIN keys ON keys.id = key_id, clock
             WHERE sessions.sha256 = $1 AND sessions.expires_at_ms > now_ms",
        );
        Ok(one.bind(sha256).fetch_optional(&self.pool).await?)
    }

    async fn delete_session(&self, sha256: &str) -> Result<(), StoreError> {
        let delete = sqlx::query("DELETE FROM sessions WHERE sha256 = $1").bind(sha256);
        delete.execute(&self.pool).await?;
        Ok(())
    }
}

/// Signs out those who signed in with a key, which the transaction holds.
async fn sign_out(connection: &mut PgConnection, key_id: &str) -> sqlx::Result<()> {
    let delete = sqlx::query("DELETE FROM sessions WHERE key_id = $1").bind(key_id);
    delete.execute(connection).await?;
    Ok(())
}
