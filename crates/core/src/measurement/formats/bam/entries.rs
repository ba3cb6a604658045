//! The entries of a log, as columns.

use serde_json::{Map, Value};

use crate::measurement::formats::fault::Fault;
use crate::measurement::formats::json::kind;
use crate::measurement::formats::json_table::{check_count, element, number, object};
use crate::measurement::formats::table::join_path;

/// Name of the column of times, s.
pub(super) const TIME: &str = "timestamp";

/// Name of the column of positions, rad.
pub(super) const POSITION: &str = "position";

/// Name of the column that is worked out: the goal of the controller less the position, rad.
pub(super) const ERROR: &str = "error";

const GOAL: &str = "goal_position";

const TORQUE: &str = "torque_enable";

/// Columns that do not drive the axis: times, the motion and its goal, the supply and the temperature.
const NOT_DRIVING: [&str; 7] = [TIME, POSITION, "speed", GOAL, "input_volts", "temp", TORQUE];

/// The entries, one number of each column for every entry.
pub(super) struct Entries {
    /// Whether the torque was on.
    pub(super) torque_on: Vec<bool>,
    columns: Vec<(String, Vec<f64>)>,
}

impl Entries {
    /// The entries of a log. The columns are what the first entry has numbers for.
    ///
    /// # Errors
    /// If there is no entry, an entry lacks a number that the first one has, or the entries have no
    /// time or position of their own.
    pub(super) fn of(log: &Map<String, Value>) -> Result<Self, Fault> {
        let entries = match log.get("entries") {
            Some(Value::Array(entries)) => entries,
            _ => return Err(Fault::new("an array is needed").in_column("entries")),
        };
        check_count(entries.len(), "entries")?;
        let Some(first) = entries.first() else {
            return Err(Fault::new("the log has no entry").in_column("entries"));
        };
        let first = object(first, &element("entries", 0))?;
        let numbers = first.iter().filter(|(_, value)| value.is_number());
        let mut columns: Vec<(String, Vec<f64>)> =
            numbers.map(|(name, _)| (name.clone(), Vec::new())).collect();
        let mut torque_on = Vec::new();
        for (index, entry) in entries.iter().enumerate() {
            let path = element("entries", index);
            let entry = object(entry, &path)?;
            for (name, values) in &mut columns {
                let value = entry.get(name).map_or(Ok(None), number);
                let value = value.and_then(|value| value.ok_or("the value is missing".into()));
                values.push(value.map_err(|reason| place(index, name, reason))?);
            }
            torque_on.push(is_on(entry.get(TORQUE)).map_err(|fault| place(index, TORQUE, fault))?);
        }
        let mut entries = Self { torque_on, columns };
        entries.require(POSITION)?;
        entries.require(TIME)?;
        entries.add_error();
        Ok(entries)
    }

    /// The numbers of a column.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(of, _)| of == name).map(|(_, values)| values.as_slice())
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// If the entries do not have it.
    pub(super) fn require(&self, name: &str) -> Result<&[f64], Fault> {
        self.column(name).ok_or_else(|| {
            Fault::new(format!(
                "the entries have no number `{name}`; where each has several joints, write those \
                 of one joint as entries of a log"
            ))
            .in_column("entries[0]")
        })
    }

    /// The names of the columns that may drive the axis: those that change while the torque is on.
    pub(super) fn driving(&self) -> Vec<&str> {
        let changes = |values: &[f64]| {
            let mut driven = values.iter().zip(&self.torque_on).filter(|(_, on)| **on);
            let first = driven.next();
            first.is_some_and(|(first, _)| driven.any(|(value, _)| value != first))
        };
        let driving = self.columns.iter();
        let driving = driving.filter(|(name, values)| !never_drives(name) && changes(values));
        driving.map(|(name, _)| name.as_str()).collect()
    }

    fn add_error(&mut self) {
        let (Some(goal), Some(position)) = (self.column(GOAL), self.column(POSITION)) else {
            return;
        };
        let error = goal.iter().zip(position).map(|(goal, position)| goal - position).collect();
        if self.column(ERROR).is_none() {
            self.columns.push((ERROR.to_owned(), error));
        }
    }
}

/// Whether a column with this name is none that drives the axis.
pub(super) fn never_drives(name: &str) -> bool {
    NOT_DRIVING.contains(&name)
}

/// A fault of one number of an entry.
pub(super) fn place(index: usize, name: &str, reason: impl Into<String>) -> Fault {
    Fault::new(reason).in_column(join_path(&element("entries", index), name))
}

/// Whether the torque is on; where nothing says so, it is.
fn is_on(value: Option<&Value>) -> Result<bool, String> {
    match value {
        None | Some(Value::Null) => Ok(true),
        Some(Value::Bool(on)) => Ok(*on),
        Some(Value::Number(number)) => Ok(number.as_f64() != Some(0.0)),
        Some(other) => Err(format!("true or false is needed, not {}", kind(other))),
    }
}
