//! Keys by which a repeated request is recognised.

use sqlx::PgConnection;

use crate::store::{IdempotencyKey, Inserted, Reach};

/// Claims a key for a resource about to be inserted in the same transaction. A request with the
/// same key that another transaction is about to answer is waited for.
pub(super) async fn claim(
    connection: &mut PgConnection,
    reach: &Reach,
    scope: &'static str,
    key: Option<&IdempotencyKey>,
    resource_id: &str,
) -> sqlx::Result<Inserted> {
    let Some(key) = key else { return Ok(Inserted::Created) };
    loop {
        let claimed = sqlx::query(
            "INSERT INTO idempotency_keys
                 (scope, key, body_sha256, resource_id, created_at_ms, owner)
             VALUES ($1, $2, $3, $4, (SELECT now_ms FROM clock), $5)
             ON CONFLICT DO NOTHING",
        )
        .bind(scope)
        .bind(&key.key)
        .bind(&key.body_sha256)
        .bind(resource_id)
        .bind(&reach.owner)
        .execute(&mut *connection)
        .await?;
        if claimed.rows_affected() == 1 {
            return Ok(Inserted::Created);
        }
        let earlier: Option<(String, String)> = sqlx::query_as(
            "SELECT body_sha256, resource_id FROM idempotency_keys
             WHERE scope = $1 AND key = $2 AND owner = $3",
        )
        .bind(scope)
        .bind(&key.key)
        .bind(&reach.owner)
        .fetch_optional(&mut *connection)
        .await?;
        match earlier {
            Some((digest, id)) if digest == key.body_sha256 => return Ok(Inserted::Replayed(id)),
            Some(_) => return Ok(Inserted::KeyReused),
            // Its resource was deleted in between.
            None => {}
        }
    }
}
