//! Converts JSON rows (an array of objects) and columns (an object of arrays) into a [`Table`], and
//! reads values of JSON.

use indexmap::IndexSet;
use serde_json::{Map, Value};

use super::columns::Column;
use super::fault::Fault;
use super::json::kind;
use super::limits::MAX_ROWS;
use super::table::{Place, Table, join_path};

/// A table from an array of objects. `shared` are cells that are given once outside the array and
/// apply to all its rows.
pub(super) fn of_rows(
    rows: &[Value],
    path: &str,
    format: &[Column],
    shared: &[(Column, Option<f64>)],
    notes: &mut IndexSet<String>,
) -> Result<Table, Fault> {
    check_count(rows.len(), path)?;
    let mut columns: Vec<Column> = shared.iter().map(|(column, _)| *column).collect();
    for (index, row) in rows.iter().enumerate() {
        for key in object(row, &element(path, index))?.keys() {
            match Column::find(key, format) {
                Some(column) if shared.iter().any(|(held, _)| *held == column) => {
                    return Err(Fault::new("given both here and beside the rows")
                        .in_column(join_path(&element(path, index), key)));
                }
                Some(column) if !columns.contains(&column) => columns.push(column),
                Some(_) => {}
                None => note_unknown(&join_path(path, key), notes),
            }
        }
    }
    let mut table = Table::new(columns.clone(), Some(Place::Object(path.to_owned())));
    for (index, row) in rows.iter().enumerate() {
        let row_path = element(path, index);
        let row = object(row, &row_path)?;
        let cells =
            columns.iter().enumerate().map(|(position, column)| match shared.get(position) {
                Some((_, value)) => Ok(*value),
                None => row.get(column.name()).map_or(Ok(None), number),
            });
        table.push(Place::Object(row_path), cells)?;
    }
    Ok(table)
}

/// A table from an object of arrays.
pub(super) fn of_columns(
    object: &Map<String, Value>,
    path: &str,
    format: &[Column],
) -> Result<Table, Fault> {
    let arrays = format
        .iter()
        .filter_map(|column| object.get(column.name()).map(|value| (*column, value)))
        .map(|(column, value)| match value {
            Value::Array(array) => Ok((column, array)),
            other => Err(Fault::new(format!("an array is needed, not {}", kind(other)))
                .in_column(join_path(path, column.name()))),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let length = arrays.first().map_or(0, |(_, array)| array.len());
    check_count(length, path)?;
    for (column, array) in &arrays {
        if array.len() != length {
            return Err(Fault::new(format!(
                "the array has {} elements, {} has {length}",
                array.len(),
                arrays[0].0.name()
            ))
            .in_column(join_path(path, column.name())));
        }
    }
    let columns = arrays.iter().map(|(column, _)| *column).collect();
    let mut table = Table::new(columns, Some(Place::Object(path.to_owned())));
    for index in 0..length {
        let cells = arrays.iter().map(|(_, array)| number(&array[index]));
        table.push(Place::Element(path.to_owned(), index), cells)?;
    }
    Ok(table)
}

/// The value that a text is.
pub(super) fn parse(text: &str) -> Result<Value, Fault> {
    serde_json::from_str(text).map_err(|error| {
        Fault::new(format!("the text is not JSON: {error}")).at_line(Some(error.line() as u64))
    })
}

/// The text of a string or a number.
pub(super) fn scalar(value: &Value, path: &str) -> Result<String, Fault> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        other => Err(Fault::new(format!("a string or a number is needed, not {}", kind(other)))
            .in_column(path)),
    }
}

/// Path of an element of an array.
pub(super) fn element(path: &str, index: usize) -> String {
    format!("{path}[{index}]")
}

/// The object at a path.
pub(super) fn object<'a>(value: &'a Value, path: &str) -> Result<&'a Map<String, Value>, Fault> {
    value.as_object().ok_or_else(|| {
        Fault::new(format!("an object is needed, not {}", kind(value))).in_column(path)
    })
}

/// Adds a note that a key is unknown, unless there is one already.
pub(super) fn note_unknown(path: &str, notes: &mut IndexSet<String>) {
    notes.insert(format!("{path} is unknown and not used"));
}

/// A number, or `None` if the value is null.
pub(super) fn number(value: &Value) -> Result<Option<f64>, String> {
    match value {
        Value::Null => Ok(None),
        Value::Number(number) => {
            number.as_f64().map(Some).ok_or_else(|| format!("{number} is not a usable number"))
        }
        other => Err(format!("a number is needed, not {}", kind(other))),
    }
}

/// Refuses more rows than are read.
pub(super) fn check_count(count: usize, path: &str) -> Result<(), Fault> {
    if count > MAX_ROWS {
        return Err(Fault::new(format!("more than {MAX_ROWS} rows")).in_column(path));
    }
    Ok(())
}
