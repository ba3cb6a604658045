//! Stored mappings. Each owner has names of its own; a caller who reads those of others finds its
//! own first.

use async_trait::async_trait;
use sqlx::PgPool;

use crate::store::{MappingRow, Mappings, Reach, StoreError};

use super::{Engine, locks};

#[async_trait]
impl Mappings for Engine {
    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError> {
        Ok(put(&self.pool, reach, row, most).await?)
    }

    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError> {
        Ok(get(&self.pool, reach, name).await?)
    }

    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError> {
        Ok(of_layout(&self.pool, reach, layout).await?)
    }

    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError> {
        Ok(list(&self.pool, reach, limit).await?)
    }

    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError> {
        Ok(delete(&self.pool, reach, name).await?)
    }
}

/// Stores a mapping; `false`: in place of one of its owner's with its name. `None`: it would be a new
/// one beyond `most`.
pub(super) async fn put(
    pool: &PgPool,
    reach: &Reach,
    row: &MappingRow,
    most: u32,
) -> sqlx::Result<Option<bool>> {
    let mut transaction = pool.begin().await?;
    locks::wait_for(&mut transaction, locks::MAPPINGS, &reach.owner).await?;
    // A row that was updated has a transaction in `xmax`.
    let created = sqlx::query_scalar(
        "INSERT INTO mappings (name, settings, layout, updated_at_ms, owner)
         SELECT $1, $2, $3, (SELECT now_ms FROM clock), $4
         WHERE EXISTS (SELECT 1 FROM mappings WHERE name = $1 AND owner = $4)
            OR (SELECT count(*) FROM mappings WHERE owner = $4) < $5
         ON CONFLICT (owner, name) DO UPDATE SET settings = excluded.settings,
             layout = excluded.layout, updated_at_ms = excluded.updated_at_ms
         RETURNING xmax = 0",
    )
    .bind(&row.name)
    .bind(&row.settings)
    .bind(&row.layout)
    .bind(&reach.owner)
    .bind(i64::from(most))
    .fetch_optional(&mut *transaction)
    .await?;
    transaction.commit().await?;
    Ok(created)
}

pub(super) async fn get(
    pool: &PgPool,
    reach: &Reach,
    name: &str,
) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE name = $1 AND ($2 IS NULL OR owner = $2)
         ORDER BY owner <> $3, owner LIMIT 1",
    )
    .bind(name)
    .bind(reach.read())
    .bind(&reach.owner)
    .fetch_optional(pool)
    .await
}

/// Nobody asked for it by its name: that of another owner does not change how files are read.
pub(super) async fn of_layout(
    pool: &PgPool,
    reach: &Reach,
    layout: &str,
) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE layout = $1 AND owner = $2
         ORDER BY updated_at_ms DESC, name LIMIT 1",
    )
    .bind(layout)
    .bind(&reach.owner)
    .fetch_optional(pool)
    .await
}

pub(super) async fn list(
    pool: &PgPool,
    reach: &Reach,
    limit: u32,
) -> sqlx::Result<Vec<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE ($2 IS NULL OR owner = $2)
         ORDER BY name, owner <> $3, owner LIMIT $1",
    )
    .bind(i64::from(limit))
    .bind(reach.read())
    .bind(&reach.owner)
    .fetch_all(pool)
    .await
}

pub(super) async fn delete(pool: &PgPool, reach: &Reach, name: &str) -> sqlx::Result<bool> {
    let done = sqlx::query(
        "DELETE FROM mappings WHERE (owner, name) IN (
             SELECT owner, name FROM mappings WHERE name = $1 AND ($2 IS NULL OR owner = $2)
             ORDER BY owner <> $3, owner LIMIT 1)",
    )
    .bind(name)
    .bind(reach.changed())
    .bind(&reach.owner)
    .execute(pool)
    .await?;
    Ok(done.rows_affected() == 1)
}
