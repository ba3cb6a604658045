//! One value of a row, as every engine and the file have it.

use serde_json::{Number, Value, json};
use sqlx::{ColumnIndex, Decode, Row, Type};

use super::tables::{Column, Kind};

/// One value of a row.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::store) enum Cell {
    Null,
    Integer(i64),
    Real(f64),
    Text(String),
    Bytes(Vec<u8>),
    Flag(bool),
}

impl Cell {
    /// As JSON; of bytes only how many there are.
    pub(super) fn to_json(&self) -> Value {
        match self {
            Self::Null => Value::Null,
            Self::Integer(value) => json!(value),
            // JSON has no word for what is not finite.
            Self::Real(value) => {
                Number::from_f64(*value).map_or_else(|| json!(value.to_string()), Value::Number)
            }
            Self::Text(value) => json!(value),
            Self::Bytes(value) => json!({"bytes": value.len()}),
            Self::Flag(value) => json!(value),
        }
    }

    /// From JSON, for a column; `None` where the column holds nothing of the kind. Bytes are read
    /// elsewhere.
    pub(super) fn from_json(value: Value, column: &Column) -> Option<Self> {
        Some(match (column.kind, value) {
            (_, Value::Null) => Self::Null,
            (Kind::Integer, Value::Number(value)) => Self::Integer(value.as_i64()?),
            (Kind::Real, Value::Number(value)) => Self::Real(value.as_f64()?),
            (Kind::Real, Value::String(value)) => Self::Real(value.parse().ok()?),
            (Kind::Text, Value::String(value)) => Self::Text(value),
            (Kind::Flag, Value::Bool(value)) => Self::Flag(value),
            _ => return None,
        })
    }
}

/// The cells of a row that has these columns in this order.
pub(in crate::store) fn cells<'r, R: Row>(row: &'r R, columns: &[Column]) -> sqlx::Result<Vec<Cell>>
where
    usize: ColumnIndex<R>,
    i64: Decode<'r, R::Database> + Type<R::Database>,
    f64: Decode<'r, R::Database> + Type<R::Database>,
    bool: Decode<'r, R::Database> + Type<R::Database>,
    String: Decode<'r, R::Database> + Type<R::Database>,
    Vec<u8>: Decode<'r, R::Database> + Type<R::Database>,
{
    let read = |(at, column): (usize, &Column)| match column.kind {
        Kind::Integer => read(row, at, Cell::Integer),
        Kind::Real => read(row, at, Cell::Real),
        Kind::Text => read(row, at, Cell::Text),
        Kind::Bytes => read(row, at, Cell::Bytes),
        Kind::Flag => read(row, at, Cell::Flag),
    };
    columns.iter().enumerate().map(read).collect()
}

/// The cell at a position of a row.
fn read<'r, R: Row, T>(row: &'r R, at: usize, cell: impl FnOnce(T) -> Cell) -> sqlx::Result<Cell>
where
    usize: ColumnIndex<R>,
    T: Decode<'r, R::Database> + Type<R::Database>,
{
    Ok(row.try_get::<Option<T>, _>(at)?.map_or(Cell::Null, cell))
}
