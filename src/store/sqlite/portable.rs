//! Everything, to and from a backup.

use async_trait::async_trait;
use futures_util::TryStreamExt as _;
use sqlx::{AssertSqlSafe, QueryBuilder, SqliteConnection};

use crate::store::backup::{BackupError, Cell, Portable, Reader, Section, TABLES, Writer, cells};

use super::Sqlite;

/// Rows, and bytes, that are inserted together.
const ROWS: usize = 200;
const BYTES: usize = 1 << 20;

#[async_trait]
impl Portable for Sqlite {
    async fn back_up(&self, into: &mut Writer<'_>) -> Result<(), BackupError> {
        let mut transaction = self.readers.begin().await?;
        back_up(&mut transaction, into).await?;
        transaction.rollback().await?;
        Ok(())
    }

    async fn restore(&self, from: &mut Reader<'_>) -> Result<(), BackupError> {
        let mut transaction = self.begin().await?;
        restore(&mut transaction, from).await?;
        transaction.commit().await?;
        // Into the file itself, and onto the disk.
        sqlx::query("PRAGMA wal_checkpoint(TRUNCATE)").execute(&self.writer).await?;
        Ok(())
    }
}

/// Writes every table, in a transaction that has one view of them all.
async fn back_up(
    connection: &mut SqliteConnection,
    into: &mut Writer<'_>,
) -> Result<(), BackupError> {
    for table in TABLES {
        into.begin(table)?;
        let mut rows = sqlx::query(AssertSqlSafe(table.select())).fetch(&mut *connection);
        while let Some(row) = rows.try_next().await? {
            into.row(&cells(&row, table.columns)?)?;
        }
    }
    Ok(())
}

/// Fills empty tables.
async fn restore(
    connection: &mut SqliteConnection,
    from: &mut Reader<'_>,
) -> Result<(), BackupError> {
    let mut filled = Vec::new();
    for table in TABLES {
        let any = format!("SELECT EXISTS (SELECT 1 FROM {})", table.name);
        let any = sqlx::query_scalar(AssertSqlSafe(any)).fetch_one(&mut *connection);
        if any.await? {
            filled.push(table.name);
        }
    }
    if !filled.is_empty() {
        return Err(BackupError::NotEmpty(filled.join(", ")));
    }
    while let Some(section) = from.section()? {
        let (mut rows, mut bytes) = (Vec::new(), 0);
        while let Some(row) = from.row()? {
            bytes += row.iter().map(size).sum::<usize>();
            rows.push(row);
            if rows.len() == ROWS || bytes >= BYTES {
                insert(connection, &section, std::mem::take(&mut rows)).await?;
                bytes = 0;
            }
        }
        if !rows.is_empty() {
            insert(connection, &section, rows).await?;
        }
    }
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

fn size(cell: &Cell) -> usize {
    match cell {
        Cell::Text(text) => text.len(),
        Cell::Bytes(bytes) => bytes.len(),
        _ => size_of::<Cell>(),
    }
}

async fn insert(
    connection: &mut SqliteConnection,
    section: &Section,
    rows: Vec<Vec<Cell>>,
) -> sqlx::Result<()> {
    let columns: Vec<&str> = section.columns().collect();
    let begin = format!("INSERT INTO {} ({}) ", section.name(), columns.join(", "));
    let mut statement = QueryBuilder::<sqlx::Sqlite>::new(begin);
    statement.push_values(rows, |mut values, row| {
        for cell in row {
            match cell {
                Cell::Null => values.push_bind(None::<i64>),
                Cell::Integer(value) => values.push_bind(value),
                Cell::Real(value) => values.push_bind(value),
                Cell::Text(value) => values.push_bind(value),
                Cell::Bytes(value) => values.push_bind(value),
                Cell::Flag(value) => values.push_bind(value),
            };
        }
    });
    statement.build().execute(connection).await?;
    Ok(())
}
