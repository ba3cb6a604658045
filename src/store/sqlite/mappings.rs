//! Stored mappings.

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::MappingRow;

/// Stores a mapping; `false`: in place of one of its name.
pub(super) async fn put(connection: &mut SqliteConnection, row: &MappingRow) -> sqlx::Result<bool> {
    let known: bool = sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM mappings WHERE name = ?1)")
        .bind(&row.name)
        .fetch_one(&mut *connection)
        .await?;
    sqlx::query(
        "INSERT INTO mappings (name, settings, layout, updated_at_ms)
         VALUES (?1, ?2, ?3, (SELECT now_ms FROM clock))
         ON CONFLICT (name) DO UPDATE SET settings = excluded.settings,
             layout = excluded.layout, updated_at_ms = excluded.updated_at_ms",
    )
    .bind(&row.name)
    .bind(&row.settings)
    .bind(&row.layout)
    .execute(connection)
    .await?;
    Ok(!known)
}

pub(super) async fn get(pool: &SqlitePool, name: &str) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as("SELECT * FROM mappings WHERE name = ?1").bind(name).fetch_optional(pool).await
}

pub(super) async fn of_layout(pool: &SqlitePool, layout: &str) -> sqlx::Result<Option<MappingRow>> {
    sqlx::query_as(
        "SELECT * FROM mappings WHERE layout = ?1 ORDER BY updated_at_ms DESC, name LIMIT 1",
    )
    .bind(layout)
    .fetch_optional(pool)
    .await
}

pub(super) async fn list(pool: &SqlitePool, limit: u32) -> sqlx::Result<Vec<MappingRow>> {
    sqlx::query_as("SELECT * FROM mappings ORDER BY name LIMIT ?1")
        .bind(limit)
        .fetch_all(pool)
        .await
}

pub(super) async fn delete(connection: &mut SqliteConnection, name: &str) -> sqlx::Result<bool> {
    let done =
        sqlx::query("DELETE FROM mappings WHERE name = ?1").bind(name).execute(connection).await?;
    Ok(done.rows_affected() == 1)
}
