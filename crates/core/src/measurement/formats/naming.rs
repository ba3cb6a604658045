//! Finds which columns of the contract the columns of a text are.
//!
//! Names of the contract come first. If they are all that a table needs, nothing else is looked at,
//! and the other columns are noted as unknown. Otherwise the names of the vocabulary fill in what
//! is missing. Two columns that could both be the same thing are refused.

use super::by_vocabulary;
use super::columns::{self, Column};
use super::fault::Fault;
use super::header::Header;
use super::lack;
use super::name::{self, Name};
use super::vocabulary::{Holds, Measures};
use crate::measurement::ResponseKind;
use crate::measurement::units;

/// One column that is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Used {
    pub(super) column: Column,
    /// Its position in the text.
    pub(super) field: usize,
    /// Factor and divisor to the unit of the contract.
    pub(super) scale: [f64; 2],
}

impl Used {
    /// A column whose numbers have the unit of the contract.
    pub(super) fn plain(column: Column, field: usize) -> Self {
        Self { column, field, scale: [1.0, 1.0] }
    }

    /// A number in the unit of the contract.
    pub(super) fn convert(&self, number: f64) -> f64 {
        number * self.scale[0] / self.scale[1]
    }
}

/// The field of a column that the text does not have: the number of the row, from 0.
pub(super) const ROW_NUMBER: usize = usize::MAX;

/// What the columns of a text are.
#[derive(Debug, Default)]
pub(super) struct Naming {
    /// The columns that are used.
    pub(super) used: Vec<Used>,
    /// Whether they are those of a time record.
    pub(super) timed: bool,
    /// What is said of them.
    pub(super) notes: Vec<String>,
}

/// Finds which columns of the contract these are, and takes over the quantities that they name into
/// the metadata.
///
/// # Errors
/// If two columns could be the same thing, a unit is unknown or missing or contradicts the name, or
/// the kind of the response is not said.
pub(super) fn resolve(names: &[Name], header: &mut Header) -> Result<Naming, Fault> {
    if let Some(naming) = by_contract(names, header)? {
        return Ok(naming);
    }
    by_vocabulary::resolve(names, header)
}

/// The columns if those with names of the contract are all that a table needs.
fn by_contract(names: &[Name], header: &mut Header) -> Result<Option<Naming>, Fault> {
    let of = |format: &'static [Column]| {
        let exact = names.iter().enumerate();
        let exact = exact.filter_map(|(field, name)| Some(Used::plain(name.contract?, field)));
        exact.filter(|used| format.contains(&used.column)).collect::<Vec<_>>()
    };
    let timed = names.iter().any(|name| name.contract == Some(Column::TimeS));
    let used = of(if timed { columns::TIME_RECORD } else { columns::HARMONIC_TABLE });
    let has = |column| used.iter().any(|used| used.column == column);
    let complete = if timed {
        has(Column::Input) && has(Column::Output)
    } else {
        (has(Column::OmegaRadS) || has(Column::FrequencyHz))
            && columns::RESPONSE_FORMS.iter().any(|form| has(*form))
            && (has(Column::Magnitude) || has(Column::URe) || header.magnitude.is_some())
    };
    if !complete {
        return Ok(None);
    }
    check_twice(names, &used)?;
    let mut notes = Vec::new();
    for used in &used {
        check_unit(&names[used.field], used.column, header)?;
    }
    note_unused(names, &used, &mut notes);
    Ok(Some(Naming { used, timed, notes }))
}

/// Refuses a name that is used and given twice.
fn check_twice(names: &[Name], used: &[Used]) -> Result<(), Fault> {
    for (index, this) in used.iter().enumerate() {
        if used[..index].iter().any(|other| other.column == this.column) {
            return Err(Fault::new("this column is named twice")
                .in_column(names[this.field].written.to_ascii_lowercase()));
        }
    }
    Ok(())
}

/// Takes over what a name tells of the input or the response (`key`) where there is no column of
/// it: of the two signals of a frequency response.
///
/// # Errors
/// If the kind of the response is neither told nor stated, or the two contradict.
pub(super) fn take_quantity(key: &str, written: &str, header: &mut Header) -> Result<(), Fault> {
    let name = Name::of(written, None);
    match (key, name.holds) {
        ("input", Some(Holds::Input(quantity))) => {
            header.infer("input", &format!("{quantity} [{}]", name.unit), written)
        }
        ("input", _) => Ok(()),
        (_, Some(Holds::Motion(kind))) => response(header, kind, &name),
        _ if header.states("response") => Ok(()),
        _ => Err(unknown_kind()),
    }
}

/// Checks the unit of a column with a name of the contract, and takes over that of an input or a
/// response.
pub(super) fn check_unit(name: &Name, column: Column, header: &mut Header) -> Result<(), Fault> {
    if name.unit.is_empty() {
        return Ok(());
    }
    let is = |unit: &str| name::unit(&name.unit).is_some_and(|known| known.names.contains(&unit));
    let right = match column {
        Column::TimeS => is("s"),
        Column::FrequencyHz => is("Hz"),
        Column::OmegaRadS => is("rad/s"),
        Column::PhaseDeg | Column::PhaseStdDeg => is("deg"),
        Column::GainDb | Column::GainDbStd => is("dB"),
        Column::Input => {
            let quantity = driven_by(&name.unit).unwrap_or("input");
            return header.infer("input", &format!("{quantity} [{}]", name.unit), &name.written);
        }
        Column::Output => return output_unit(name, header),
        _ => true,
    };
    match right {
        true => Ok(()),
        false => Err(Fault::new(format!(
            "the unit below the name is `{}`, but the name says another",
            name.unit
        ))
        .in_column(name.written.as_str())),
    }
}

/// The quantity that a unit drives an axis with.
pub(super) fn driven_by(unit: &str) -> Option<&'static str> {
    match name::unit(unit)?.measures {
        Measures::Drive(quantity) => Some(quantity),
        _ => None,
    }
}

/// Takes over the unit of the response where the kind is that of the metadata or is not stated.
fn output_unit(name: &Name, header: &mut Header) -> Result<(), Fault> {
    let kind = units::kind_of(&name.unit).unwrap_or(header.metadata.response_kind);
    response(header, kind, name)
}

pub(super) fn response(header: &mut Header, kind: ResponseKind, name: &Name) -> Result<(), Fault> {
    let kind = format!("{kind:?}").to_lowercase();
    header.infer("response", &format!("{kind} {}", name.unit), &name.written)
}

pub(super) fn note_unused(names: &[Name], used: &[Used], notes: &mut Vec<String>) {
    for (field, name) in names.iter().enumerate() {
        if used.iter().any(|used| used.field == field) {
            continue;
        }
        notes.push(match name.written.as_str() {
            "" => format!("column {} has no name and is not used", field + 1),
            written if name.is_known() => format!("column {written} is not used"),
            written => format!("column {written} is unknown and not used"),
        });
    }
}

/// Asks for the kind of the response.
pub(super) fn unknown_kind() -> Fault {
    let lack = lack::ask("response", "velocity rad/s");
    Fault::new(format!(
        "state whether the response is a velocity, a position or an acceleration: {lack}"
    ))
    .lacking(lack)
}
