//! Reads JSON uploads. They can hold the same data as CSV, and mix records and harmonic tables.

use indexmap::IndexSet;
use serde_json::{Map, Value};

use super::columns::{self, Column};
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::header::Header;
use super::json_table::{
    element, note_unknown, number, object, of_columns, of_rows, parse, scalar,
};
use super::limits::{MAX_EXPERIMENTS, too_many_experiments};
use super::part::Part;
use super::table::{Table, join_path};
use super::time_record::Read;
use super::{harmonic_table, time_record};
use crate::measurement::Lines;

/// Keys that hold the data; one of them is needed.
const DATA_KEYS: [&str; 3] = ["rows", "columns", "experiments"];

/// Settings that a single record of several may override.
const RECORD_SETTINGS: [&str; 5] =
    ["period_s", "settle_periods", "initial_velocity", "initial_position", "settle_s"];

/// Columns that are given once for an experiment, next to its `harmonics`.
const SHARED_COLUMNS: [Column; 5] =
    [Column::Magnitude, Column::OmegaRadS, Column::FrequencyHz, Column::Averages, Column::Run];

/// Any text that begins as JSON does.
pub(super) const FORMAT: Format = Format {
    name: "JSON",
    is: |content| content.begins_with(&["{", "["]),
    read: |content, given| read(content.text()?, given),
    see: |_, _| None,
};

/// Reads a whole upload.
fn read(text: &str, given: &Given) -> Result<Part, Fault> {
    let value = parse(text)?;
    let mut notes = IndexSet::new();
    let upload = match &value {
        Value::Array(rows) => {
            let mut header = Header::default();
            take(&mut header, given, &mut notes)?;
            return read_table(
                |format, notes| of_rows(rows, "", format, &[], notes),
                rows.iter().any(|row| row.get(Column::TimeS.name()).is_some()),
                header,
                notes,
            );
        }
        other => object(other, "")?,
    };
    let mut header = header(upload, &mut notes)?;
    take(&mut header, given, &mut notes)?;
    let mut given = DATA_KEYS.iter().filter_map(|key| upload.get(*key).map(|value| (*key, value)));
    let Some((key, data)) = given.next() else {
        return Err(Fault::new("one of rows, columns and experiments is needed"));
    };
    if let Some((other, _)) = given.next() {
        return Err(
            Fault::new(format!("{key} and {other} contradict: give one of them")).in_column(other)
        );
    }
    if key == "columns" {
        let data = object(data, key)?;
        for name in data.keys() {
            let formats = [columns::HARMONIC_TABLE, columns::TIME_RECORD];
            if formats.iter().all(|format| Column::find(name, format).is_none()) {
                note_unknown(&join_path(key, name), &mut notes);
            }
        }
        let timed = data.contains_key(Column::TimeS.name());
        return read_table(|format, _| of_columns(data, key, format), timed, header, notes);
    }
    let rows = array(data, key)?;
    if key == "rows" {
        let timed = rows.iter().any(|row| row.get(Column::TimeS.name()).is_some());
        return read_table(
            |format, notes| of_rows(rows, key, format, &[], notes),
            timed,
            header,
            notes,
        );
    }
    if rows.len() > MAX_EXPERIMENTS {
        return Err(Fault::new(too_many_experiments(rows.len())).in_column(key));
    }
    let (mut experiments, mut transients) = (Vec::new(), Vec::new());
    for (index, value) in rows.iter().enumerate() {
        let path = element(key, index);
        experiment(object(value, &path)?, &path, &header, &mut notes)?
            .push(&mut experiments, &mut transients);
    }
    if experiments.is_empty() && transients.is_empty() {
        return Err(Fault::new("the array is empty").in_column(key));
    }
    let (notes, lines) = (notes.into_iter().collect(), Lines::new());
    Ok(Part { header, experiments, transients, notes, lines, runs_from_clock: false })
}

fn take(header: &mut Header, given: &Given, notes: &mut IndexSet<String>) -> Result<(), Fault> {
    let mut said = Vec::new();
    header.take(given, &mut said)?;
    notes.extend(said);
    Ok(())
}

/// Type of a value, for messages.
pub(super) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

fn read_table(
    table: impl Fn(&[Column], &mut IndexSet<String>) -> Result<Table, Fault>,
    timed: bool,
    header: Header,
    mut notes: IndexSet<String>,
) -> Result<Part, Fault> {
    let format = if timed { columns::TIME_RECORD } else { columns::HARMONIC_TABLE };
    let table = table(format, &mut notes)?;
    if table.len() == 0 {
        return Err(table.fault(None, "there is no row"));
    }
    let notes = notes.into_iter().collect();
    if timed {
        time_record::read(&table, header, notes)
    } else {
        harmonic_table::read(&table, header, notes)
    }
}

fn experiment(
    value: &Map<String, Value>,
    path: &str,
    header: &Header,
    notes: &mut IndexSet<String>,
) -> Result<Read, Fault> {
    if value.contains_key(Column::TimeS.name()) {
        return record(value, path, header, notes);
    }
    let harmonics = value.get("harmonics").ok_or_else(|| {
        Fault::new("an experiment needs time_s,input,output or harmonics").in_column(path)
    })?;
    let rows_path = join_path(path, "harmonics");
    let rows = array(harmonics, &rows_path)?;
    let mut shared = Vec::new();
    for key in value.keys().filter(|key| *key != "harmonics") {
        match Column::find(key, &SHARED_COLUMNS) {
            Some(column) => shared.push((column, cell(value, path, column.name())?)),
            None => note_unknown(&join_path("experiments", key), notes),
        }
    }
    // All rows belong to one experiment, even if they differ in magnitude or frequency, which is
    // then refused.
    shared.push((Column::Experiment, Some(0.0)));
    let table = of_rows(rows, &rows_path, columns::HARMONIC_TABLE, &shared, notes)?;
    let mut part = harmonic_table::read(&table, header.clone(), Vec::new())?;
    notes.extend(part.notes);
    part.experiments
        .pop()
        .map(Read::Periods)
        .ok_or_else(|| Fault::new("the array has no harmonic").in_column(rows_path))
}

fn record(
    value: &Map<String, Value>,
    path: &str,
    header: &Header,
    notes: &mut IndexSet<String>,
) -> Result<Read, Fault> {
    const SAMPLES: [Column; 3] = [Column::TimeS, Column::Input, Column::Output];
    let mut own = header.clone();
    for (key, setting) in value {
        if RECORD_SETTINGS.contains(&key.as_str()) {
            // A fresh header, because `set` refuses a key with two different values, and the
            // experiment's setting may differ from that of the upload.
            let mut fresh = Header::default();
            fresh
                .set(None, key, &scalar(setting, &join_path(path, key))?)
                .map_err(|fault| fault.in_column(join_path(path, key)))?;
            match key.as_str() {
                "period_s" => {
                    (own.period_s, own.aperiodic) = (fresh.period_s, fresh.aperiodic);
                }
                "settle_periods" => own.settle_periods = fresh.settle_periods,
                "initial_velocity" => own.beginning.velocity = fresh.beginning.velocity,
                "initial_position" => own.beginning.position = fresh.beginning.position,
                _ => own.beginning.settle_s = fresh.beginning.settle_s,
            }
        } else if key != Column::Run.name() && Column::find(key, &SAMPLES).is_none() {
            note_unknown(&join_path("experiments", key), notes);
        }
    }
    let table = of_columns(value, path, &SAMPLES)?;
    let run = cell(value, path, Column::Run.name())?;
    time_record::read_one(&table, run, &own)
}

/// The metadata at the top level and in `metadata`.
fn header(upload: &Map<String, Value>, notes: &mut IndexSet<String>) -> Result<Header, Fault> {
    let mut header = Header::default();
    for (key, value) in upload {
        if key == "metadata" {
            for (key, value) in object(value, "metadata")? {
                set(&mut header, key, value, &join_path("metadata", key), notes)?;
            }
        } else if !DATA_KEYS.contains(&key.as_str()) {
            set(&mut header, key, value, key, notes)?;
        }
    }
    Ok(header)
}

fn set(
    header: &mut Header,
    key: &str,
    value: &Value,
    path: &str,
    notes: &mut IndexSet<String>,
) -> Result<(), Fault> {
    if key == "labels" {
        for (label, value) in object(value, path)? {
            let path = join_path(path, label);
            header.set(None, &format!("label.{label}"), &scalar(value, &path)?)?;
        }
        return Ok(());
    }
    if Header::knows(key) && value.is_null() {
        return Ok(());
    }
    let known = Header::knows(key)
        && header.set(None, key, &scalar(value, path)?).map_err(|fault| fault.in_column(path))?;
    if !known {
        note_unknown(path, notes);
    }
    Ok(())
}

fn array<'a>(value: &'a Value, path: &str) -> Result<&'a Vec<Value>, Fault> {
    value.as_array().ok_or_else(|| {
        Fault::new(format!("an array is needed, not {}", kind(value))).in_column(path)
    })
}

/// The number under a key of an object, if there is one.
fn cell(object: &Map<String, Value>, path: &str, key: &str) -> Result<Option<f64>, Fault> {
    object
        .get(key)
        .map_or(Ok(None), number)
        .map_err(|reason| Fault::new(reason).in_column(join_path(path, key)))
}
