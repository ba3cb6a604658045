//! Measurements and their files.

use sqlx::{SqliteConnection, SqlitePool};

use crate::store::decode::label_pairs;
use crate::store::{
    Description, FileRow, IdempotencyKey, Inserted, MeasurementFilter, MeasurementRow, Page, Reach,
    RereadRow, Rereading,
};

use super::idempotency;

pub(super) async fn insert(
    connection: &mut SqliteConnection,
    reach: &Reach,
    row: &MeasurementRow,
    files: &[FileRow],
    key: Option<&IdempotencyKey>,
) -> sqlx::Result<Inserted> {
    let claim = idempotency::claim(connection, reach, "measurement", key, &row.id).await?;
    if claim != Inserted::Created {
        return Ok(claim);
    }
    sqlx::query(
        "INSERT INTO measurements
             (id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
              experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
              omega_max_rad_s, notes, quantities, simulation_s, diagnosis_s,
              owner)
         VALUES (?1, (SELECT now_ms FROM clock), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12,
                 ?13, ?14, ?15, ?16, ?17, ?18, ?19)",
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
    .bind(&row.quantities)
    .bind(row.simulation_s)
    .bind(row.diagnosis_s)
    .bind(&reach.owner)
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
    Ok(claim)
}

pub(super) async fn get(
    pool: &SqlitePool,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Option<MeasurementRow>> {
    sqlx::query_as(
        "SELECT id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
                experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
                omega_max_rad_s, notes, quantities, simulation_s, diagnosis_s,
                (SELECT json_group_array(name ORDER BY position) FROM measurement_files
                 WHERE measurement_id = measurements.id) AS files
         FROM measurements WHERE id = ?1 AND (?2 IS NULL OR owner = ?2)",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_optional(pool)
    .await
}

pub(super) async fn files(
    pool: &SqlitePool,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<Vec<FileRow>> {
    sqlx::query_as(
        "SELECT name, content_type, bytes FROM measurement_files
         WHERE measurement_id = ?1
           AND (?2 IS NULL OR EXISTS (SELECT 1 FROM measurements WHERE id = ?1 AND owner = ?2))
         ORDER BY position",
    )
    .bind(id)
    .bind(reach.read())
    .fetch_all(pool)
    .await
}

pub(super) async fn list(
    pool: &SqlitePool,
    reach: &Reach,
    filter: &MeasurementFilter,
    page: &Page,
) -> sqlx::Result<Vec<MeasurementRow>> {
    sqlx::query_as(
        "SELECT id, created_at_ms, name, machine, axis, operator, measured_at, labels, sha256,
                experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
                omega_max_rad_s, notes, quantities, simulation_s, diagnosis_s,
                (SELECT json_group_array(name ORDER BY position) FROM measurement_files
                 WHERE measurement_id = measurements.id) AS files
         FROM measurements
         WHERE (?1 IS NULL OR id < ?1)
           AND (?2 IS NULL OR machine = ?2)
           AND (?3 IS NULL OR axis = ?3)
           AND (?4 IS NULL OR created_at_ms >= ?4)
           AND (?5 IS NULL OR created_at_ms < ?5)
           AND (?6 IS NULL OR unixepoch(measured_at, 'subsec') * 1000 >= ?6)
           AND (?7 IS NULL OR unixepoch(measured_at, 'subsec') * 1000 < ?7)
           AND NOT EXISTS (SELECT 1 FROM json_each(?8) AS wanted
                           WHERE NOT EXISTS (
                               SELECT 1 FROM json_each(measurements.labels) AS label
                               WHERE label.key = json_extract(wanted.value, '$[0]')
                                 AND label.value = json_extract(wanted.value, '$[1]')))
           AND (?9 IS NULL OR sha256 = ?9)
           AND (?10 IS NULL
                OR instr(lower(concat_ws(char(10), name, machine, axis, operator, labels)), lower(?10))
                OR EXISTS (SELECT 1 FROM measurement_files
                           WHERE measurement_id = measurements.id
                             AND instr(lower(measurement_files.name), lower(?10))))
           AND (?12 IS NULL OR owner = ?12)
         ORDER BY id DESC LIMIT ?11",
    )
    .bind(&page.before)
    .bind(&filter.machine)
    .bind(&filter.axis)
    .bind(filter.since_ms)
    .bind(filter.until_ms)
    .bind(filter.measured_since_ms)
    .bind(filter.measured_until_ms)
    .bind(label_pairs(&filter.labels))
    .bind(&filter.sha256)
    .bind(&filter.text)
    .bind(page.limit)
    .bind(reach.read())
    .fetch_all(pool)
    .await
}

pub(super) async fn describe(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
    description: &Description,
) -> sqlx::Result<bool> {
    let done = sqlx::query(
        "UPDATE measurements
         SET name = ?2, machine = ?3, axis = ?4, operator = ?5, measured_at = ?6, labels = ?7
         WHERE id = ?1 AND (?8 IS NULL OR owner = ?8)",
    )
    .bind(id)
    .bind(&description.name)
    .bind(&description.machine)
    .bind(&description.axis)
    .bind(&description.operator)
    .bind(&description.measured_at)
    .bind(&description.labels)
    .bind(reach.changed())
    .execute(connection)
    .await?;
    Ok(done.rows_affected() == 1)
}

pub(super) async fn reread(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
    reread: &RereadRow,
) -> sqlx::Result<Rereading> {
    let within: Option<String> = sqlx::query_scalar(
        "SELECT id FROM measurements WHERE id = ?1 AND (?2 IS NULL OR owner = ?2)",
    )
    .bind(id)
    .bind(reach.changed())
    .fetch_optional(&mut *connection)
    .await?;
    if within.is_none() {
        return Ok(Rereading::Unknown);
    }
    let has_jobs: bool =
        sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM jobs WHERE measurement_id = ?1)")
            .bind(id)
            .fetch_one(&mut *connection)
            .await?;
    if has_jobs {
        return Ok(Rereading::HasJobs);
    }
    let RereadRow { row, given_name, given } = reread;
    sqlx::query(
        "UPDATE measurements
         SET sha256 = ?2, experiments = ?3, highest_harmonic = ?4, magnitude_min = ?5,
             magnitude_max = ?6, omega_min_rad_s = ?7, omega_max_rad_s = ?8, notes = ?9,
             quantities = ?10, simulation_s = ?11, diagnosis_s = ?12
         WHERE id = ?1",
    )
    .bind(id)
    .bind(&row.sha256)
    .bind(row.experiments)
    .bind(row.highest_harmonic)
    .bind(row.magnitude_min)
    .bind(row.magnitude_max)
    .bind(row.omega_min_rad_s)
    .bind(row.omega_max_rad_s)
    .bind(&row.notes)
    .bind(&row.quantities)
    .bind(row.simulation_s)
    .bind(row.diagnosis_s)
    .execute(&mut *connection)
    .await?;
    sqlx::query("DELETE FROM measurement_files WHERE measurement_id = ?1 AND name = ?2")
        .bind(id)
        .bind(given_name)
        .execute(&mut *connection)
        .await?;
    if let Some(file) = given {
        sqlx::query(
            "INSERT INTO measurement_files (measurement_id, position, name, content_type, bytes)
             SELECT ?1, coalesce(max(position), -1) + 1, ?2, ?3, ?4
             FROM measurement_files WHERE measurement_id = ?1",
        )
        .bind(id)
        .bind(&file.name)
        .bind(&file.content_type)
        .bind(&file.bytes)
        .execute(connection)
        .await?;
    }
    Ok(Rereading::Stored)
}

pub(super) async fn delete(
    connection: &mut SqliteConnection,
    reach: &Reach,
    id: &str,
) -> sqlx::Result<bool> {
    let within: bool = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM measurements WHERE id = ?1 AND (?2 IS NULL OR owner = ?2))",
    )
    .bind(id)
    .bind(reach.changed())
    .fetch_one(&mut *connection)
    .await?;
    if !within {
        return Ok(false);
    }
    sqlx::query(
        "DELETE FROM idempotency_keys
         WHERE resource_id = ?1
            OR resource_id IN (SELECT id FROM jobs WHERE measurement_id = ?1)",
    )
    .bind(id)
    .execute(&mut *connection)
    .await?;
    sqlx::query("DELETE FROM jobs WHERE measurement_id = ?1")
        .bind(id)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM measurements WHERE id = ?1").bind(id).execute(connection).await?;
    Ok(true)
}
