//! Whether columns are those of a time record or of a harmonic table: some names mean different
//! things in the two.

use crate::measurement::ResponseKind;
use crate::measurement::formats::columns::{self, Column};
use crate::measurement::formats::header::Header;
use crate::measurement::formats::name::Name;
use crate::measurement::formats::vocabulary::Holds;

/// Whether the columns are those of a time record, and what their names mean there.
pub(in super::super) fn in_context(names: &[Name], header: &Header) -> (bool, Vec<Name>) {
    let timed = is_timed(names, header);
    (timed, if timed { of_record(names) } else { names.to_vec() })
}

/// Whether the columns are those of a time record: they have times and no frequency. Beside times, ω is
/// a frequency only where there is a ratio of response to input.
fn is_timed(names: &[Name], header: &Header) -> bool {
    let contract =
        |columns: &[Column]| names.iter().any(|n| n.contract.is_some_and(|c| columns.contains(&c)));
    let holds = |wanted: fn(Holds) -> bool| names.iter().any(|n| n.holds.is_some_and(wanted));
    let time = contract(&[Column::TimeS])
        || holds(|holds| holds == Holds::Time)
        || header.sample_s.is_some();
    let frequency = contract(&[Column::FrequencyHz]) || holds(|holds| holds == Holds::Frequency);
    let omega = contract(&[Column::OmegaRadS]) || holds(|holds| holds == Holds::AngularFrequency);
    let ratio = contract(columns::RESPONSE_FORMS)
        || holds(|holds| {
            matches!(
                holds,
                Holds::Gain
                    | Holds::LinearGain
                    | Holds::GainRe
                    | Holds::GainIm
                    | Holds::RealPart
                    | Holds::ImaginaryPart
            )
        });
    time && !frequency && !(omega && ratio)
}

/// The columns of a time record: ω is a velocity there, and φ or θ a position.
fn of_record(names: &[Name]) -> Vec<Name> {
    let motion = |name: &Name| {
        let is_omega =
            name.contract == Some(Column::OmegaRadS) || name.holds == Some(Holds::AngularFrequency);
        let (kind, unit) = match name.holds {
            _ if is_omega => (ResponseKind::Velocity, "rad/s"),
            Some(Holds::Phase) if name.is_symbol => (ResponseKind::Position, ""),
            _ => return name.clone(),
        };
        let unit = if name.unit.is_empty() { unit } else { &name.unit };
        let (holds, unit) = (Some(Holds::Motion(kind)), unit.to_owned());
        Name { contract: None, holds, unit, ..name.clone() }
    };
    names.iter().map(motion).collect()
}
