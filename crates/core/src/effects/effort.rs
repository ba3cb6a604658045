//! Words that follow the units of a measurement: force or torque.

/// What the input is a measure of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A force.
    Force,
    /// A torque.
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

impl Effort {
    /// What a unit of the input is a unit of.
    pub fn of(input_unit: &str) -> Self {
        let factors = factors(input_unit);
        let joined = ["Nm", "mNm", "kNm", "cNm", "ozin", "lbin", "lbft", "kgfcm"];
        match factors.as_slice() {
            [one] if joined.contains(one) => Self::Torque,
            [force, length] if FORCES.contains(force) && LENGTHS.contains(length) => Self::Torque,
            [one] if FORCES.contains(one) => Self::Force,
            _ => Self::Other,
        }
    }
}

/// What moves the axis: a force where it is linear, a torque where it turns.
fn mover(input_unit: &str, response_unit: &str) -> &'static str {
    let response = factors(response_unit);
    let is_among = |known: &[&str]| response.first().is_some_and(|unit| known.contains(unit));
    match Effort::of(input_unit) {
        Effort::Force => "force",
        Effort::Torque => "torque",
        Effort::Other if is_among(ANGLES) => "torque",
        Effort::Other if is_among(LENGTHS) => "force",
        Effort::Other => EITHER,
    }
}

/// What moves an axis of which neither unit says whether it turns.
const EITHER: &str = "force or torque";

/// A text that says `torque`, for an axis with these units. A text that was fitted before stays as
/// it is.
pub fn fit_words(text: &str, input_unit: &str, response_unit: &str) -> String {
    text.replace(EITHER, "torque").replace("torque", mover(input_unit, response_unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_not_called_a_torque() {
        let word = |input, response| fit_words("a torque acts", input, response);
        assert_eq!(word("N", "m"), "a force acts");
        assert_eq!(word("N m", "rad/s"), "a torque acts");
        assert_eq!(word("A", "mm/s"), "a force acts");
        assert_eq!(word("A", "mrad/s"), "a torque acts");
        assert_eq!(word("V", "(rad/s)"), "a torque acts");
        assert_eq!(word("", ""), "a force or torque acts");
    }

    #[test]
    fn words_that_were_fitted_before_are_fitted_once() {
        for [input, response] in [["", ""], ["N", "m"], ["A", "rad"]] {
            let once = fit_words("a torque acts", input, response);
            assert_eq!(fit_words(&once, input, response), once);
        }
    }
}
