//! Reads the `key: value` metadata of one file.

mod keys;

use std::collections::BTreeMap;

use super::convention::Convention;
use super::decimal::Mark;
use super::fault::Fault;
use super::given::Given;
use super::limits::{MAX_LABELS, MAX_METADATA};
use crate::measurement::{Beginning, Intersample, Metadata};

/// Metadata of one file, and the settings for reading its numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Header {
    pub(super) metadata: Metadata,
    pub(super) convention: Convention,
    /// Period of a time record, s.
    pub(super) period_s: Option<f64>,
    /// Whether the file states that a time record has no period (`period_s: none`).
    pub(super) aperiodic: bool,
    /// Course of the input of a record without period between samples.
    pub(super) intersample: Option<Intersample>,
    /// Initial state of a record without period.
    pub(super) beginning: Beginning,
    /// Periods to drop at the beginning of a time record, if stated.
    pub(super) settle_periods: Option<usize>,
    /// Averages behind each `coherence` of a harmonic table, where a row does not state its own.
    pub(super) averages: Option<f64>,
    /// Whether the repeats of a harmonic table are the periods of one record.
    pub(super) repeats_are_periods: bool,
    /// Magnitude of the input in every row of a harmonic table, in its amplitude convention.
    pub(super) magnitude: Option<f64>,
    /// Decimal mark of a text, if stated.
    pub(super) decimal: Option<Mark>,
    /// Whether the response is read with the opposite sign.
    pub(super) inverted: bool,
    /// Whether rows of a time record with a blank segment are left out (ramps and settling).
    pub(super) blank_segments_unused: bool,
    /// Time between the samples of a record that has no column of times, s.
    pub(super) sample_s: Option<f64>,
    /// Names of the columns of a text, in place of those that it has.
    pub(super) column_names: Option<Vec<String>>,
    /// Line and value of every key seen.
    seen: BTreeMap<String, (Option<u64>, String)>,
}

impl Header {
    /// Reads one `key: value`; returns `false` if the key is unknown. Upper and lower case do not
    /// matter.
    pub(super) fn set(&mut self, line: Option<u64>, key: &str, value: &str) -> Result<bool, Fault> {
        // A JSON string may hold line breaks, which would corrupt a CSV preamble written from it.
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        let fault = |reason: String| Fault::new(reason).at_line(line).in_column(key);
        let folded = folded(key);
        if is_of_instrument(key, &folded, &value) {
            return Ok(false);
        }
        let key = folded.as_str();
        if !self.apply(key, &value).map_err(fault)? {
            return Ok(false);
        }
        self.check_storable(key, &value).map_err(fault)?;
        if let Some((_, earlier)) = self.seen.get(key)
            && *earlier != value
        {
            return Err(fault(format!("given twice: `{earlier}` and `{value}`")));
        }
        self.seen.insert(key.to_owned(), (line, value));
        Ok(true)
    }

    /// Refuses what no list of measurements has room for, and what not every database keeps.
    fn check_storable(&self, key: &str, value: &str) -> Result<(), String> {
        if key.contains('\0') || value.contains('\0') {
            return Err("it has a NUL character; remove it".into());
        }
        let longest = key.len().max(if key == "column_names" { 0 } else { value.len() });
        if longest > MAX_METADATA {
            return Err(format!("it has {longest} bytes; at most {MAX_METADATA} are taken"));
        }
        if self.metadata.labels.len() > MAX_LABELS {
            return Err(format!("there are more than {MAX_LABELS} labels"));
        }
        Ok(())
    }

    /// Takes over what is given beside the file. Where the file says something else, a note says
    /// so.
    pub(super) fn take(&mut self, given: &Given, notes: &mut Vec<String>) -> Result<(), Fault> {
        for (key, value) in given.entries() {
            match self.seen.remove(key) {
                Some((_, earlier)) if earlier != value => notes.push(format!(
                    "{key} is `{value}`, as given with the upload, not `{earlier}`, as in the file"
                )),
                _ => {}
            }
            self.set(None, key, value)?;
        }
        Ok(())
    }

    /// Takes over the input or the response that the name of a column tells.
    ///
    /// # Errors
    /// If the metadata states another unit, or another kind of the response.
    pub(super) fn infer(&mut self, key: &str, value: &str, column: &str) -> Result<(), Fault> {
        let mut told = Self::default();
        told.set(None, key, value).map_err(|fault| fault.in_column(column))?;
        let of = |header: &mut Self| match key {
            "input" => header.metadata.input.clone(),
            _ => header.metadata.response.clone(),
        };
        let (stated, told_quantity) = (of(self), of(&mut told));
        if !self.states(key) {
            self.metadata.response_kind = match key {
                "input" => self.metadata.response_kind,
                _ => told.metadata.response_kind,
            };
        }
        let kinds_differ =
            key == "response" && told.metadata.response_kind != self.metadata.response_kind;
        let units_differ = !stated.unit.is_empty()
            && !told_quantity.unit.is_empty()
            && stated.unit != told_quantity.unit;
        if kinds_differ || units_differ {
            return Err(Fault::new(format!(
                "the column is `{}`, but the {key} is stated as `{} {}`: correct the one or the \
                 other",
                [told_quantity.name, told_quantity.unit].join(" ").trim(),
                stated.name,
                stated.unit
            ))
            .in_column(column));
        }
        let open = match key {
            "input" => &mut self.metadata.input,
            _ => &mut self.metadata.response,
        };
        if open.name.is_empty() {
            open.name = told_quantity.name;
        }
        if open.unit.is_empty() {
            open.unit = told_quantity.unit;
        }
        Ok(())
    }

    /// Whether the key was given.
    pub(super) fn states(&self, key: &str) -> bool {
        self.seen.contains_key(key)
    }

    /// Whether the key is known.
    pub(super) fn knows(key: &str) -> bool {
        !matches!(Self::default().apply(&folded(key), ""), Ok(false))
    }

    /// Whether the key is known and in its own spelling.
    pub(super) fn has_exactly(key: &str) -> bool {
        Self::knows(key) && folded(key) == key
    }

    /// Line of the file in which a key was given.
    pub(super) fn line_of(&self, key: &str) -> Option<u64> {
        self.seen.get(key).and_then(|(line, _)| *line)
    }
}

/// Keys whose value is one of a few words.
const WORDED: &[&str] = &[
    "loop",
    "reference",
    "amplitude",
    "intersample",
    "decimal",
    "inverted",
    "blank_segments",
    "repeats",
];

/// A key in lower case, but for the name of a label.
fn folded(key: &str) -> String {
    const LABEL: &str = "label.";
    let (start, rest) = key.split_at_checked(LABEL.len()).unwrap_or((key, ""));
    match start.eq_ignore_ascii_case(LABEL) {
        true => format!("{LABEL}{rest}"),
        false => key.to_ascii_lowercase(),
    }
}

/// Whether a line states a setting of an instrument, such as `#Amplitude: 1 V`: a number where the
/// key in lower case has a word.
fn is_of_instrument(key: &str, folded: &str, value: &str) -> bool {
    let number = value.starts_with(|c: char| c.is_ascii_digit() || ['+', '-', '.'].contains(&c));
    key != folded && number && WORDED.contains(&folded)
}

#[cfg(test)]
mod tests;
