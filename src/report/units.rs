//! Words that follow the units of a measurement: force or torque.

/// What the command is a measure of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    Force,
    Torque,
    /// A current, a voltage, or whatever else was commanded.
    Other,
}

const FORCES: &[&str] = &["N", "mN", "kN", "MN", "lbf", "kgf", "dyn"];
const LENGTHS: &[&str] = &["m", "mm", "cm", "dm", "um", "µm", "μm", "nm", "in", "inch", "ft"];
const ANGLES: &[&str] = &[
    "rad", "mrad", "urad", "µrad", "deg", "°", "rev", "r", "turn", "turns", "rpm", "arcsec",
    "arcmin",
];

/// The factors of the numerator of a unit: `N m`, `N·m/rad` and `Nm` begin with N and m.
fn factors(unit: &str) -> Vec<&str> {
    let unit = unit.trim_start_matches('(');
    let numerator = unit.split(['/', ')']).next().unwrap_or_default();
    numerator.split([' ', '·', '*', '.', '⋅']).filter(|part| !part.is_empty()).collect()
}

/// What a unit of the command is a unit of.
pub(super) fn effort(input_unit: &str) -> Effort {
    let factors = factors(input_unit);
    let joined = ["Nm", "mNm", "kNm", "cNm", "ozin", "lbin", "lbft", "kgfcm"];
    match factors.as_slice() {
        [one] if joined.contains(one) => Effort::Torque,
        [force, length] if FORCES.contains(force) && LENGTHS.contains(length) => Effort::Torque,
        [one] if FORCES.contains(one) => Effort::Force,
        _ => Effort::Other,
    }
}

/// What friction is called where it is drawn in units of the command.
pub(super) fn friction(input_unit: &str) -> &'static str {
    match effort(input_unit) {
        Effort::Force => "Friction force",
        Effort::Torque => "Friction torque",
        Effort::Other => "Friction",
    }
}

/// What moves the axis: a force where it is linear, a torque where it turns.
fn mover(input_unit: &str, response_unit: &str) -> &'static str {
    let response = factors(response_unit);
    let is_among = |known: &[&str]| response.first().is_some_and(|unit| known.contains(unit));
    match effort(input_unit) {
        Effort::Force => "force",
        Effort::Torque => "torque",
        Effort::Other if is_among(ANGLES) => "torque",
        Effort::Other if is_among(LENGTHS) => "force",
        Effort::Other => "force or torque",
    }
}

/// A text of the library of effects, which says `torque`, for an axis with these units.
pub(super) fn fitting(text: &str, input_unit: &str, response_unit: &str) -> String {
    text.replace("torque", mover(input_unit, response_unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_not_called_a_torque() {
        let word = |input, response| fitting("a torque acts", input, response);
        assert_eq!(word("N", "m"), "a force acts");
        assert_eq!(word("N m", "rad/s"), "a torque acts");
        assert_eq!(word("A", "mm/s"), "a force acts");
        assert_eq!(word("A", "mrad/s"), "a torque acts");
        assert_eq!(word("V", "(rad/s)"), "a torque acts");
        assert_eq!(word("", ""), "a force or torque acts");
    }

    #[test]
    fn friction_in_units_of_a_current_is_neither() {
        let named = ["N", "kN", "N·m", "mNm", "N m", "A", "", "%"].map(friction);
        let [force, torque] = ["Friction force", "Friction torque"];
        let other = "Friction";
        assert_eq!(named, [force, force, torque, torque, torque, other, other, other]);
    }
}
