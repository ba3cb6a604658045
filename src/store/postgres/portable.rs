//! Everything, to and from a backup.

use async_trait::async_trait;
use futures_util::TryStreamExt as _;
use sqlx::{AssertSqlSafe, PgConnection};

use crate::store::backup::{BackupError, Cell, Portable, Reader, Section, TABLES, Writer, cells};

use super::Engine;
use super::measurements::measured_at_ms;

/// Bytes that are sent together.
const BYTES: usize = 1 << 16;

/// A transaction that only reads, and sees everything as it was when it began.
const ONE_MOMENT: &str = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY";

#[async_trait]
impl Portable for Engine {
    async fn back_up(&self, into: &mut Writer<'_>) -> Result<(), BackupError> {
        let mut transaction = self.pool.begin_with(ONE_MOMENT).await?;
        back_up(&mut transaction, into).await?;
        transaction.rollback().await?;
        Ok(())
    }

    async fn restore(&self, from: &mut Reader<'_>) -> Result<(), BackupError> {
        let mut transaction = self.pool.begin().await?;
        restore(&mut transaction, from).await?;
        transaction.commit().await?;
        Ok(())
    }
}

/// Writes every table, in a transaction that has one view of them all.
async fn back_up(connection: &mut PgConnection, into: &mut Writer<'_>) -> Result<(), BackupError> {
    for table in TABLES {
        into.begin(table)?;
        let mut rows = sqlx::query(AssertSqlSafe(table.select())).fetch(&mut *connection);
        while let Some(row) = rows.try_next().await? {
            into.row(&cells(&row, table.columns)?)?;
        }
    }
    Ok(())
}

/// Fills empty tables, which nobody else may write to until the transaction ends.
async fn restore(connection: &mut PgConnection, from: &mut Reader<'_>) -> Result<(), BackupError> {
    let names: Vec<&str> = TABLES.iter().map(|table| table.name).collect();
    let lock = format!("LOCK TABLE {} IN EXCLUSIVE MODE", names.join(", "));
    sqlx::query(AssertSqlSafe(lock)).execute(&mut *connection).await?;
    let mut filled = Vec::new();
    for name in names {
        let any = format!("SELECT EXISTS (SELECT 1 FROM {name})");
        let any = sqlx::query_scalar(AssertSqlSafe(any)).fetch_one(&mut *connection);
        if any.await? {
            filled.push(name);
        }
    }
    if !filled.is_empty() {
        return Err(BackupError::NotEmpty(filled.join(", ")));
    }
    while let Some(section) = from.section()? {
        copy(connection, from, &section).await?;
    }
    sqlx::query("SELECT setval('lowest_turn', 0)").execute(&mut *connection).await?;
    sqlx::query(
        "SELECT setval(pg_get_serial_sequence('events', 'id'), max(id)) FROM events
         HAVING max(id) IS NOT NULL",
    )
    .execute(&mut *connection)
    .await?;
    sqlx::query(
        "UPDATE jobs
         SET status = CASE WHEN cancel_requested THEN 'cancelled' ELSE 'queued' END,
             finished_at_ms =
                 CASE WHEN cancel_requested THEN (SELECT now_ms FROM clock) ELSE NULL END,
             handed_back = handed_back + 1, lease_until_ms = NULL, progress = NULL
         WHERE status = 'running'",
    )
    .execute(connection)
    .await?;
    Ok(())
}

/// Copies the rows of one table.
async fn copy(
    connection: &mut PgConnection,
    from: &mut Reader<'_>,
    section: &Section,
) -> Result<(), BackupError> {
    let mut columns: Vec<&str> = section.columns().collect();
    // When something was measured is also kept as a number.
    let measured_at = columns.iter().position(|column| *column == "measured_at");
    if measured_at.is_some() {
        columns.push("measured_at_ms");
    }
    let statement = format!("COPY {} ({}) FROM STDIN", section.name(), columns.join(", "));
    let mut copying = connection.copy_in_raw(&statement).await?;
    let mut lines = Vec::new();
    loop {
        let row = match from.row() {
            Ok(Some(row)) => row,
            Ok(None) => break,
            Err(error) => {
                // That it was given up is no news.
                let _ = copying.abort("the backup cannot be read").await;
                return Err(error);
            }
        };
        let ms = measured_at.map(|at| match &row[at] {
            Cell::Text(text) => measured_at_ms(Some(text)).map_or(Cell::Null, Cell::Integer),
            _ => Cell::Null,
        });
        line(&mut lines, row.iter().chain(&ms));
        if lines.len() >= BYTES {
            copying.send(std::mem::take(&mut lines)).await?;
        }
    }
    copying.send(lines).await?;
    copying.finish().await?;
    Ok(())
}

/// Writes a row as `COPY` reads it.
fn line<'c>(into: &mut Vec<u8>, cells: impl Iterator<Item = &'c Cell>) {
    for (at, cell) in cells.enumerate() {
        if at > 0 {
            into.push(b'\t');
        }
        match cell {
            Cell::Null => into.extend(b"\\N"),
            Cell::Integer(value) => into.extend(value.to_string().bytes()),
            Cell::Real(value) => into.extend(value.to_string().bytes()),
            Cell::Text(text) => text.bytes().for_each(|byte| character(into, byte)),
            Cell::Bytes(bytes) => {
                into.extend(b"\\\\x");
                for byte in bytes {
                    for digit in [byte >> 4, byte & 15] {
                        into.push(b"0123456789abcdef"[usize::from(digit)]);
                    }
                }
            }
            Cell::Flag(value) => into.push(if *value { b't' } else { b'f' }),
        }
    }
    into.push(b'\n');
}

fn character(into: &mut Vec<u8>, byte: u8) {
    match byte {
        b'\\' => into.extend(b"\\\\"),
        b'\t' => into.extend(b"\\t"),
        b'\n' => into.extend(b"\\n"),
        b'\r' => into.extend(b"\\r"),
        // Postgres keeps every character but this one.
        0 => into.extend("\u{fffd}".bytes()),
        byte => into.push(byte),
    }
}
