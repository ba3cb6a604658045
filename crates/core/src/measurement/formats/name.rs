//! Understands the name of a column: what it holds, and in which unit.

use super::columns::{self, Column};
use super::limits::MAX_NAME;
use super::vocabulary::{
    Holds, Measures, NAMES, NOT_MEASURED, PARTS_NOT_MEASURED, SUFFIXES, SYMBOLS, UNITS, Unit, WORDS,
};
use crate::measurement::units;

/// The name of a column, understood as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    /// As the file has it.
    pub(super) written: String,
    /// The column of the contract that has exactly this name.
    pub(super) contract: Option<Column>,
    /// What it holds if it is no name of the contract, or one without the unit that it needs here.
    pub(super) holds: Option<Holds>,
    /// The unit; empty if it is not said.
    pub(super) unit: String,
    /// Whether it is the symbol of a physical quantity.
    pub(super) is_symbol: bool,
}

impl Name {
    /// Understands a name, with the unit that a row of units gives for it, if there is one.
    pub(super) fn of(written: &str, unit_below: Option<&str>) -> Self {
        if written.len() > MAX_NAME {
            let (written, unit) = (written.to_owned(), String::new());
            return Self { written, contract: None, holds: None, unit, is_symbol: false };
        }
        let contract = contract(written);
        let (name, unit) = match contract.is_some() || whole(written).is_some() {
            true => (written.to_owned(), String::new()),
            false => split(written),
        };
        let unit = match unit_below.map(bare) {
            Some(below) if unit.is_empty() => below.to_owned(),
            // Refused later, as no known unit.
            Some(below) if !below.is_empty() && below != unit => format!("{unit} or {below}"),
            _ => unit,
        };
        // A ratio in dB is neither the amplitude of an input nor a linear gain.
        let decibel = self::unit(&unit).is_some_and(|unit| unit.measures == Measures::Decibel);
        let ratio = [Column::Magnitude, Column::Amplitude, Column::Gain];
        let contract = contract.filter(|column| !(decibel && ratio.contains(column)));
        let holds = holds_in(&name, &unit).or_else(|| match quantity(&name) {
            Some(_) => None,
            None => by_unit(&unit).filter(|holds| is_measured(&name, *holds)),
        });
        let is_symbol = is_symbol(&name);
        Self { written: written.to_owned(), contract, holds, unit, is_symbol }
    }

    /// Whether the name is known.
    pub(super) fn is_known(&self) -> bool {
        self.contract.is_some() || self.holds.is_some()
    }

    /// Whether the column is one along which a table runs.
    pub(super) fn is_axis(&self) -> bool {
        let of_contract = [Column::TimeS, Column::FrequencyHz, Column::OmegaRadS];
        self.contract.is_some_and(|column| of_contract.contains(&column))
            || matches!(self.holds, Some(Holds::Time | Holds::Frequency | Holds::AngularFrequency))
    }
}

/// The column of the contract with this name.
pub(super) fn contract(name: &str) -> Option<Column> {
    let name = name.to_ascii_lowercase();
    [columns::TIME_RECORD, columns::HARMONIC_TABLE]
        .into_iter()
        .find_map(|format| Column::find(&name, format))
}

/// A known unit of times, frequencies, angles, ratios or inputs.
pub(super) fn unit(name: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.names.contains(&name))
}

/// Whether a cell of a row is a unit.
pub(super) fn is_unit(cell: &str) -> bool {
    let cell = bare(cell);
    unit(cell).is_some() || units::kind_of(cell).is_some()
}

/// A unit without the brackets around it.
pub(super) fn bare(unit: &str) -> &str {
    let unit = unit.trim();
    let inner = [('(', ')'), ('[', ']'), ('<', '>')].into_iter().find_map(|(open, close)| {
        unit.strip_prefix(open).and_then(|rest| rest.strip_suffix(close))
    });
    inner.unwrap_or(unit).trim()
}

/// Splits a name from its unit: `Time [ms]`, `Time (ms)`, `Zeit in ms`, `t / ms`, `Gain, dB`,
/// `time_ms`.
fn split(written: &str) -> (String, String) {
    let text = written.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let parts = text.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((name, unit)) = parts.filter(|(name, _)| !name.trim().is_empty()) {
            return (name.trim().to_owned(), unit.trim().to_owned());
        }
    }
    // A unit may have a blank or a stroke of its own: `Speed rad/s`, `t / ms`.
    for between in [" in ", " ", "/", ","] {
        let mut places = text.match_indices(between).map(|(at, _)| at);
        let fits = |at: &usize| {
            let unit = text[at + between.len()..].trim_start();
            !unit.starts_with('/') && holds(&text[..*at]).is_some() && is_unit(unit)
        };
        if let Some(at) = places.find(fits) {
            let unit = text[at + between.len()..].trim();
            return (text[..at].trim().to_owned(), unit.to_owned());
        }
    }
    let lower = text.to_lowercase();
    let suffixes = SUFFIXES.iter().filter_map(|(suffix, unit)| {
        let name = lower.strip_suffix(suffix)?.strip_suffix('_')?;
        holds_in(name, unit).map(|_| (name.len(), *unit))
    });
    // The longest suffix: `_rad_s` is not `_s`.
    match suffixes.min_by_key(|(length, _)| *length) {
        Some((length, unit)) => (lower[..length].to_owned(), unit.to_owned()),
        None => (text.to_owned(), String::new()),
    }
}

/// A name in the spelling of the vocabulary.
fn in_one_spelling(name: &str) -> String {
    let lower = name.to_lowercase();
    let spaced = lower.replace(['.', '_', '-', ':', '"'], " ");
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What a column with this whole name holds.
fn whole(name: &str) -> Option<Holds> {
    let name = in_one_spelling(name);
    let known = NAMES.iter().find(|(_, names)| names.contains(&name.as_str()));
    known.map(|(holds, _)| *holds)
}

fn holds(name: &str) -> Option<Holds> {
    if let Some(holds) = whole(name) {
        return Some(holds);
    }
    quantity(name)?.ok()
}

/// What a name holds where this is its unit, if its words tell. A symbol beside a unit of another
/// quantity tells nothing.
fn holds_in(name: &str, unit: &str) -> Option<Holds> {
    let holds = holds(name)?;
    let measures = self::unit(unit).map(|unit| unit.measures);
    let frequency = [Some(Measures::Frequency), Some(Measures::AngularFrequency)];
    let fits = match holds {
        Holds::Time => measures == Some(Measures::Time),
        Holds::Frequency | Holds::AngularFrequency => frequency.contains(&measures),
        Holds::Phase => measures == Some(Measures::Angle),
        _ => true,
    };
    (unit.is_empty() || fits || !is_symbol(name)).then_some(holds)
}

/// Whether a name is the symbol of a physical quantity.
fn is_symbol(name: &str) -> bool {
    SYMBOLS.contains(&in_one_spelling(name).as_str())
}

/// Whether a name is not that of the set point, a limit or an error of a motion. The set point of an
/// input is what drives the axis.
fn is_measured(name: &str, holds: Holds) -> bool {
    if !matches!(holds, Holds::Motion(_)) {
        return true;
    }
    let name = in_one_spelling(name);
    !name.split(' ').any(|word| NOT_MEASURED.contains(&word))
        && !PARTS_NOT_MEASURED.iter().any(|part| name.contains(part))
}

/// A name has several quantities, or is that of a set point, a limit or an error.
struct NotOneQuantity;

/// The quantity that the words of a name tell, if one does.
fn quantity(name: &str) -> Option<Result<Holds, NotOneQuantity>> {
    let name = in_one_spelling(name);
    let words: Vec<&str> = name.split(' ').collect();
    let mut known = WORDS.iter().filter(|(_, of)| words.iter().any(|word| of.contains(word)));
    let (holds, _) = known.next()?;
    Some(match known.next().is_none() && is_measured(&name, *holds) {
        true => Ok(*holds),
        false => Err(NotOneQuantity),
    })
}

/// What a column with an unknown name holds by its unit: an input or a motion. Degrees, Hz and
/// rad/s do not tell; they may be those of a phase or a frequency.
fn by_unit(name: &str) -> Option<Holds> {
    match unit(name).map(|unit| unit.measures) {
        Some(Measures::Drive(quantity)) => Some(Holds::Input(quantity)),
        Some(_) => None,
        None => units::kind_of(name).map(Holds::Motion),
    }
}

#[cfg(test)]
mod tests;
