//! Measurements and their files.

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::{FileRow, MeasurementFilter, MeasurementRow, Page};

pub(super) async fn insert(
    connection: &mut SqliteConnection,
    row: &MeasurementRow,
    files: &[FileRow],
) -> sqlx::Result<()> {
    sqlx::query(
        "INSERT INTO measurements
             (id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
              experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
              omega_max_rad_s, notes)
         VALUES (?1, (SELECT now_ms FROM clock), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12,
                 ?13, ?14, ?15)",
    )
    .bind(&row.id)
    .bind(&row.name)
    .bind(&row.machine)
    .bind(&row.axis)
    .bind(&row.operator)
    .bind(&row.measured_at)
    .bind(&row.labels)
    .bind(&row.sha256)
    .bind(row.experiments)
    .bind(row.highest_harmonic)
    .bind(row.magnitude_min)
    .bind(row.magnitude_max)
    .bind(row.omega_min_rad_s)
    .bind(row.omega_max_rad_s)
    .bind(&row.notes)
    .execute(&mut *connection)
    .await?;
    for (position, file) in (0_i64..).zip(files) {
        sqlx::query(
            "INSERT INTO measurement_files (measurement_id, position, name, content_type, bytes)
             VALUES (?1, ?2, ?3, ?4, ?5)",
        )
        .bind(&row.id)
        .bind(position)
        .bind(&file.name)
        .bind(&file.content_type)
        .bind(&file.bytes)
        .execute(&mut *connection)
        .await?;
    }
    Ok(())
}

pub(super) async fn get(pool: &SqlitePool, id: &str) -> sqlx::Result<Option<MeasurementRow>> {
    sqlx::query_as("SELECT * FROM measurements WHERE id = ?1").bind(id).fetch_optional(pool).await
}

pub(super) async fn files(pool: &SqlitePool, id: &str) -> sqlx::Result<Vec<FileRow>> {
    sqlx::query_as(
        "SELECT name, content_type, bytes FROM measurement_files
         WHERE measurement_id = ?1 ORDER BY position",
    )
    .bind(id)
    .fetch_all(pool)
    .await
}

pub(super) async fn list(
    pool: &SqlitePool,
    filter: &MeasurementFilter,
    page: &Page,
) -> sqlx::Result<Vec<MeasurementRow>> {
    sqlx::query_as(
        "SELECT * FROM measurements
         WHERE (?1 IS NULL OR id < ?1)
           AND (?2 IS NULL OR machine = ?2)
           AND (?3 IS NULL OR axis = ?3)
         ORDER BY id DESC LIMIT ?4",
    )
    .bind(&page.before)
    .bind(&filter.machine)
    .bind(&filter.axis)
    .bind(page.limit)
    .fetch_all(pool)
    .await
}
