//! Reads harmonic tables: groups the rows by experiment.

use std::collections::{BTreeMap, HashMap};

use super::columns::Column;
use super::fault::Fault;
use super::harmonic_row::{Entry, Key};
use super::header::Header;
use super::layout::Layout;
use super::limits::MAX_INPUT_LINES;
use super::part::Part;
use super::repeats;
use super::table::{Row, Table};
use crate::measurement::Lines;

/// The rows of one experiment.
pub(super) struct Group {
    pub(super) magnitude: Option<f64>,
    pub(super) omega_rad_s: f64,
    /// Constant added to the input, if the table has it.
    pub(super) bias: Option<f64>,
    /// Index of its first row.
    pub(super) row: usize,
    /// Rows by index of the repeat, each in ascending order of harmonics.
    pub(super) repeats: BTreeMap<u64, Vec<Entry>>,
}

/// Reads the experiments of a harmonic table.
pub(super) fn read(table: &Table, header: Header, mut notes: Vec<String>) -> Result<Part, Fault> {
    let layout = Layout::of(table, &header)?;
    let entries =
        table.rows().map(|row| Entry::read(row, layout, &header)).collect::<Result<Vec<_>, _>>()?;
    if entries.iter().any(|entry| entry.mean_had_imaginary_part) {
        notes.push("imaginary parts of harmonic 0 are not used: a mean is real".into());
    }
    for remark in entries.iter().filter_map(|entry| entry.noise.remark) {
        if !notes.iter().any(|note| note == remark) {
            notes.push(remark.into());
        }
    }
    if table.has(Column::Magnitude) && header.magnitude.is_some() {
        notes.push("the magnitude in the metadata is not used: the table has a column".into());
    }
    if table.has(Column::Averages) && !table.has(Column::Coherence) {
        notes.push("averages without coherence says nothing of the noise and is not used".into());
    }
    let groups = group(table, &entries)?;
    check_size(table, &groups)?;
    let experiments = groups
        .iter()
        .map(|group| repeats::experiment(table, group, header.repeats_are_periods))
        .collect::<Result<_, _>>()?;
    let (transients, lines) = (Vec::new(), lines(table, &groups));
    Ok(Part { header, experiments, transients, notes, lines, runs_from_clock: false })
}

/// The line of every response, by experiment, harmonic and repeat.
fn lines(table: &Table, groups: &[Group]) -> Lines {
    let mut lines = Lines::new();
    for (experiment, group) in groups.iter().enumerate() {
        for (repeat, entries) in group.repeats.values().enumerate() {
            for entry in entries.iter().filter(|entry| entry.response.is_some()) {
                if let Some(line) = table.row(entry.row).line() {
                    lines.insert((experiment, entry.harmonic, repeat), line);
                }
            }
        }
    }
    lines
}

fn group(table: &Table, entries: &[Entry]) -> Result<Vec<Group>, Fault> {
    let mut groups: Vec<Group> = Vec::new();
    let mut of_key: HashMap<Key, usize> = HashMap::new();
    let mut seen: HashMap<(usize, usize, u64), usize> = HashMap::new();
    for entry in entries {
        let index = *of_key.entry(entry.key).or_insert_with(|| {
            groups.push(Group {
                magnitude: entry.magnitude,
                omega_rad_s: entry.omega_rad_s,
                bias: entry.bias,
                row: entry.row,
                repeats: BTreeMap::new(),
            });
            groups.len() - 1
        });
        let group = &mut groups[index];
        let row = table.row(entry.row);
        check_same(table, group, entry, row)?;
        if let Some(first) = seen.insert((index, entry.harmonic, entry.repeat), entry.row) {
            return Err(row.fault(
                Column::Harmonic,
                format!(
                    "harmonic {} of the same experiment and repeat is already given at {}",
                    entry.harmonic,
                    table.row(first).name()
                ),
            ));
        }
        group.repeats.entry(entry.repeat).or_default().push(*entry);
    }
    for entries in groups.iter_mut().flat_map(|group| group.repeats.values_mut()) {
        entries.sort_by_key(|entry| entry.harmonic);
    }
    Ok(groups)
}

/// Checks that a row has the magnitude, frequency and bias of its experiment.
fn check_same(table: &Table, group: &Group, entry: &Entry, row: Row<'_>) -> Result<(), Fault> {
    let first = table.row(group.row).name();
    let settings = [
        (Column::Magnitude, entry.magnitude, group.magnitude),
        (Column::Bias, entry.bias, group.bias),
    ];
    if let Some((column, here, there)) = settings.into_iter().find(|(_, a, b)| a != b) {
        let show = |value: Option<f64>| value.map_or("none".to_owned(), |value| value.to_string());
        return Err(row.fault(
            column,
            format!(
                "{} {} differs from {} of the same experiment at {first}",
                column.name(),
                show(here),
                show(there)
            ),
        ));
    }
    if entry.omega_rad_s != group.omega_rad_s {
        let column =
            if table.has(Column::FrequencyHz) { Column::FrequencyHz } else { Column::OmegaRadS };
        return Err(row.fault(
            column,
            format!(
                "frequency {} rad/s differs from {} rad/s of the same experiment at {first}",
                entry.omega_rad_s, group.omega_rad_s
            ),
        ));
    }
    Ok(())
}

fn check_size(table: &Table, groups: &[Group]) -> Result<(), Fault> {
    let mut lines = 0;
    for group in groups {
        let entries = || group.repeats.values().flatten();
        if let Some(highest) = entries().filter(|e| e.input.is_some()).map(|e| e.harmonic).max() {
            lines += (highest + 1) * (group.repeats.len() + 1);
        }
        if lines > MAX_INPUT_LINES {
            return Err(table.row(group.row).fault_of_row(format!(
                "the measured inputs have more than {MAX_INPUT_LINES} lines from 0 to the \
                 highest harmonic of each"
            )));
        }
    }
    Ok(())
}
