//! Understands the name of a column: what it holds, and in which unit.

use super::columns::{self, Column};
use super::limits::MAX_NAME;
use super::vocabulary::{Holds, Measures, NAMES, NOT_MEASURED, SUFFIXES, UNITS, Unit, WORDS};
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
}

impl Name {
    /// Understands a name, with the unit that a row of units gives for it, if there is one.
    pub(super) fn of(written: &str, unit_below: Option<&str>) -> Self {
        if written.len() > MAX_NAME {
            let (written, unit) = (written.to_owned(), String::new());
            return Self { written, contract: None, holds: None, unit };
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
        let holds = holds(&name).or_else(|| match quantity(&name) {
            Some(_) => None,
            None => by_unit(&unit),
        });
        Self { written: written.to_owned(), contract, holds, unit }
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
    for between in [" in ", "/", ",", " "] {
        // The first place where it fits: a unit may have a blank or a stroke of its own.
        let mut places = text.match_indices(between).map(|(at, _)| at);
        let fits =
            |at: &usize| holds(&text[..*at]).is_some() && is_unit(&text[at + between.len()..]);
        if let Some(at) = places.find(fits) {
            let unit = text[at + between.len()..].trim();
            return (text[..at].trim().to_owned(), unit.to_owned());
        }
    }
    let lower = text.to_lowercase();
    let suffixes = SUFFIXES.iter().filter_map(|(suffix, unit)| {
        let name = lower.strip_suffix(suffix)?.strip_suffix('_')?;
        holds(name).map(|_| (name.len(), *unit))
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

/// A name has several quantities, or is that of a set point, a limit or an error.
struct NotOneQuantity;

/// The quantity that the words of a name tell, if one does.
fn quantity(name: &str) -> Option<Result<Holds, NotOneQuantity>> {
    let name = in_one_spelling(name);
    let words: Vec<&str> = name.split(' ').collect();
    let mut known = WORDS.iter().filter(|(_, of)| words.iter().any(|word| of.contains(word)));
    let (holds, _) = known.next()?;
    let measured = !words.iter().any(|word| NOT_MEASURED.contains(word));
    let input = matches!(holds, Holds::Input(_));
    Some(match known.next().is_none() && (measured || input) {
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
mod tests {
    use super::*;
    use crate::measurement::ResponseKind::{Acceleration, Position, Velocity};

    #[track_caller]
    fn means(written: &str, holds: Holds, unit: &str) {
        let name = Name::of(written, None);
        assert_eq!((name.holds, name.unit.as_str()), (Some(holds), unit), "{written}");
    }

    #[test]
    fn names_are_understood_with_their_units() {
        means("Frequency (Hz)", Holds::Frequency, "Hz");
        means("f [kHz]", Holds::Frequency, "kHz");
        means("f/Hz", Holds::Frequency, "Hz");
        means("Frequenz in Hz", Holds::Frequency, "Hz");
        means("ω", Holds::AngularFrequency, "");
        means("Magnitude (dB)", Holds::Gain, "dB");
        means("Gain, dB", Holds::Gain, "dB");
        means("Betrag (dB)", Holds::Gain, "dB");
        means("|H|", Holds::LinearGain, "");
        means("abs(H)", Holds::LinearGain, "");
        means("Phase (°)", Holds::Phase, "°");
        means("phase_rad", Holds::Phase, "rad");
        means("Time [ms]", Holds::Time, "ms");
        means("time_ms", Holds::Time, "ms");
        means("Zeit / s", Holds::Time, "s");
        means("Current (A)", Holds::Input("current"), "A");
        means("motor_current_a", Holds::Input("current"), "A");
        means("Drehmoment [Nm]", Holds::Input("torque"), "Nm");
        means("Torque N m", Holds::Input("torque"), "N m");
        means("Pos. actual value", Holds::Motion(Position), "");
        means("Lage (mm)", Holds::Motion(Position), "mm");
        means("Geschwindigkeit [rad/s]", Holds::Motion(Velocity), "rad/s");
        means("vel_rad_s", Holds::Motion(Velocity), "rad/s");
        means("Beschleunigung in m/s²", Holds::Motion(Acceleration), "m/s²");
        means("Channel 3 (N)", Holds::Input("force"), "N");
        means("Channel 4 [mm]", Holds::Motion(Position), "mm");
    }

    #[test]
    fn set_points_and_errors_are_not_taken_for_what_was_measured() {
        for written in ["Position set point", "Position error (mm)", "Sollwert Lage", "Colour", ""]
        {
            assert_eq!(Name::of(written, None).holds, None, "{written}");
        }
        // The set point of the current is what drives the axis.
        means("Current set point (A)", Holds::Input("current"), "A");
        // Two quantities in one name.
        assert_eq!(Name::of("Position / Velocity", None).holds, None);
    }

    #[test]
    fn a_unit_in_a_row_below_is_the_unit() {
        let name = Name::of("Zeit", Some("[ms]"));
        assert_eq!((name.holds, name.unit.as_str()), (Some(Holds::Time), "ms"));
        assert!(is_unit("(mm/s)") && is_unit("°") && is_unit("dB") && !is_unit("Zeit"));
    }

    #[test]
    fn every_name_and_unit_of_the_vocabulary_is_in_its_spelling_and_given_once() {
        let mut seen = std::collections::HashSet::new();
        for name in NAMES.iter().chain(WORDS).flat_map(|(_, names)| *names) {
            assert_eq!(in_one_spelling(name), *name);
            assert!(seen.insert(*name), "{name} is given twice");
        }
        let mut seen = std::collections::HashSet::new();
        for name in UNITS.iter().flat_map(|unit| unit.names) {
            assert!(seen.insert(*name), "{name} is given twice");
        }
        for (_, unit) in SUFFIXES {
            assert!(is_unit(unit), "{unit}");
        }
    }
}
