//! Infers the kind of a response from its unit.

use super::ResponseKind;

/// Units of length and angle, in lower case.
const DISTANCES: [&str; 18] = [
    "m", "mm", "cm", "um", "µm", "μm", "nm", "in", "inch", "rad", "mrad", "deg", "°", "rev",
    "turn", "turns", "count", "counts",
];

/// Units of rotational speed that are not written as an angle over a time.
const SPEEDS: [&str; 4] = ["rpm", "1/min", "min-1", "min⁻¹"];

/// The kind of response that a unit belongs to; `None` if the unit is unknown or belongs to no
/// motion.
pub(super) fn kind_of(unit: &str) -> Option<ResponseKind> {
    let unit: String = unit.to_lowercase().split_whitespace().collect();
    if SPEEDS.contains(&unit.as_str()) {
        return Some(ResponseKind::Velocity);
    }
    let (distance, time) = unit.split_once('/').unwrap_or((&unit, ""));
    if !DISTANCES.contains(&distance) {
        return None;
    }
    match time {
        "" => Some(ResponseKind::Position),
        "s" | "min" => Some(ResponseKind::Velocity),
        "s2" | "s²" | "s^2" | "(s^2)" | "(s²)" | "s/s" => Some(ResponseKind::Acceleration),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_tells_the_kind_of_a_response_or_nothing() {
        use ResponseKind::{Acceleration, Position, Velocity};
        for (unit, kind) in [
            ("mm", Some(Position)),
            ("Rad", Some(Position)),
            ("°", Some(Position)),
            ("m/s", Some(Velocity)),
            ("deg / s", Some(Velocity)),
            ("rpm", Some(Velocity)),
            ("rad/s²", Some(Acceleration)),
            ("m/s^2", Some(Acceleration)),
            ("", None),
            ("V", None),
            ("N·m", None),
            ("V/s", None),
        ] {
            assert_eq!(kind_of(unit), kind, "{unit}");
        }
    }
}
