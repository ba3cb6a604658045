//! Stored mappings. Each owner has names of its own; a caller who reads those of others finds its
//! own first.

use async_trait::async_trait;
use sqlx::{SqliteConnection, SqlitePool};

use crate::store::{MappingRow, Mappings, Reach, StoreError};

use super::Sqlite;

#[async_trait]
impl Mappings for Sqlite {
    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError> {
        let mut transaction = self.begin().await?;
        let created = put(&mut transaction, reach, row, most).await;
        self.end(transaction, created).await
    }

    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError> {
        Ok(get(&self.readers, reach, name).await?)
    }

    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError> {
        Ok(of_layout(&self.readers, reach, layout).await?)
    }

    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError> {
        Ok(list(&self.readers, reach, limit).await?)
    }

    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        let deleted = delete(&mut transaction, reach, name).await;
        self.end(transaction, deleted).await
    }
}

/// Stores a mapping; `false`: in place of one of its owner's with its name. `None`: it would be a new
/// one beyond `most`.
pub(super) async fn put(
    connection: &mut SqliteConnection,
    reach: &Reach,
    row: &MappingRow,
    most: u32,
) -> sqlx::Result<Option<bool>> {
    let known: bool =
        sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM mappings WHERE name = ?1 AND owner = ?2)")
            .bind(&row.name)
            .bind(&reach.owner)
            .fetch_one(&mut *connection)
            .await?;
    let count = sqlx::query_scalar::<_, i64>("SELECT count(*) FROM mappings WHERE owner = ?1");
    let count = count.bind(&reach.owner).fetch_one(&mut *connection).await?;
    if !known && count >= i64::from(most) {
        return Ok(None);
    }
    sqlx::query(
        "INSERT INTO mappings (name, settings, layout, updated_at_ms, owner)
         VALUES (?1, ?2, ?3, (SELECT now_ms FROM clock), ?4)
         ON CONFLICT (owner, name) DO UPDATE SET settings = excluded.settings,
             layout = excluded.layout, updated_at_ms = excluded.updated_at_ms",
    )
    .bind(&row.name)
    .bind(&row.settings)
    .bind(&row.layout)
    .bind(&reach.owner)
    .execute(connection)
    .await?;
    Ok(Some(!known))
}

pub(super) async fn get(
    pool: &SqlitePool,
    reach: &Reach,
    name: &str,
) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE name = ?1 AND (?2 IS NULL OR owner = ?2)
         ORDER BY owner <> ?3, owner LIMIT 1",
    )
    .bind(name)
    .bind(reach.read())
    .bind(&reach.owner)
    .fetch_optional(pool)
    .await
}

/// Nobody asked for it by its name: that of another owner does not change how files are read.
pub(super) async fn of_layout(
    pool: &SqlitePool,
    reach: &Reach,
    layout: &str,
) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE layout = ?1 AND owner = ?2
         ORDER BY updated_at_ms DESC, name LIMIT 1",
    )
    .bind(layout)
    .bind(&reach.owner)
    .fetch_optional(pool)
    .await
}

pub(super) async fn list(
    pool: &SqlitePool,
    reach: &Reach,
    limit: u32,
) -> sqlx::Result<Vec<MappingRow>> {
    sqlx::query_as(
        "SELECT name, settings, layout, updated_at_ms FROM mappings
         WHERE (?2 IS NULL OR owner = ?2)
         ORDER BY name, owner <> ?3, owner LIMIT ?1",
    )
    .bind(limit)
    .bind(reach.read())
    .bind(&reach.owner)
    .fetch_all(pool)
    .await
}

pub(super) async fn delete(
    connection: &mut SqliteConnection,
    reach: &Reach,
    name: &str,
) -> sqlx::Result<bool> {
    let done = sqlx::query(
        "DELETE FROM mappings WHERE (owner, name) IN (
             SELECT owner, name FROM mappings WHERE name = ?1 AND (?2 IS NULL OR owner = ?2)
             ORDER BY owner <> ?3, owner LIMIT 1)",
    )
    .bind(name)
    .bind(reach.changed())
    .bind(&reach.owner)
    .execute(connection)
    .await?;
    Ok(done.rows_affected() == 1)
}
