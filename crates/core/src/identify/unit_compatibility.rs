//! Checks whether the units of two measurements agree, so that the parameters of one describe the
//! other.

use crate::answers::Identification;
use crate::measurement::Measurement;

use super::units::{Units, bracketed};

/// How the units of two measurements compare.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UnitCompatibility {
    /// The units are the same.
    Same,
    /// One measurement does not state a unit; nothing contradicts.
    Unsaid {
        /// `input` or `velocity`.
        quantity: &'static str,
    },
    /// The units differ: the parameters of one measurement do not describe the other.
    Different {
        /// `input` or `velocity`.
        quantity: &'static str,
        /// Unit of the fitted measurement.
        fitted: String,
        /// Unit of the other measurement.
        here: String,
    },
}

impl UnitCompatibility {
    /// Compares the measurement that an answer was fitted to with another one. For a position or an
    /// acceleration, the unit of the velocity is compared, because parameters are given in it.
    pub fn with_answer(answer: &Identification, here: &Measurement) -> Self {
        Self::of(&fitted_in(answer), &Units::of(here))
    }

    /// Compares two measurements.
    pub fn between(fitted: &Measurement, here: &Measurement) -> Self {
        Self::of(&Units::of(fitted), &Units::of(here))
    }

    fn of(fitted: &Units, here: &Units) -> Self {
        let pairs = [
            ("input", [&fitted.input, &here.input]),
            ("velocity", [&fitted.velocity, &here.velocity]),
        ];
        let mut agreement = Self::Same;
        for (quantity, units) in pairs {
            let [fitted, here] = units.map(|unit| (is_unsaid(unit), spelled(unit)));
            if fitted.0 != here.0 {
                agreement = Self::Unsaid { quantity };
            } else if fitted.1 != here.1 {
                let [fitted, here] = units.map(String::clone);
                return Self::Different { quantity, fitted, here };
            }
        }
        agreement
    }
}

/// The units of input and velocity, recovered from the units of an answer's parameters.
fn fitted_in(answer: &Identification) -> Units {
    let unit = |name: &str| answer.parameters.get(name).map_or("", |estimate| &estimate.unit);
    let (input, gain) = (unit("fc_plus"), unit("dc_gain"));
    let velocity = gain.strip_suffix(&format!("/{}", bracketed(input))).unwrap_or(gain);
    let inner = velocity.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
    Units { input: input.to_owned(), velocity: inner.unwrap_or(velocity).to_owned() }
}

/// Whether a unit is a placeholder for one that the upload does not state.
fn is_unsaid(unit: &str) -> bool {
    ["input", "response", "response/s", "response·s", ""].contains(&unit)
}

/// A unit in canonical spelling; empty if it is not stated.
fn spelled(unit: &str) -> String {
    if is_unsaid(unit) {
        return String::new();
    }
    let bare = unit.replace([' ', '·', '*', '(', ')'], "").replace('^', "");
    let bare = bare.replace("/s2", "/s²");
    // The velocity unit of an acceleration in x/s² reads x/s²·s: shorten it to x/s.
    bare.strip_suffix("/s²s").map_or(bare.clone(), |distance| format!("{distance}/s"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::PlantRequest;
    use crate::identify::fixtures::{ACTUATORS, axis, stepped_sine};
    use crate::identify::model_fit::fit_base;
    use crate::identify::request::IdentifyRequest;
    use crate::measurement::{Metadata, Quantity, ResponseKind};
    use crate::observer::Silent;

    fn measured(input: &str, kind: ResponseKind, response: &str) -> Measurement {
        let quantity = |unit: &str| Quantity { name: String::new(), unit: unit.into() };
        let metadata = Metadata {
            input: quantity(input),
            response: quantity(response),
            response_kind: kind,
            ..Metadata::default()
        };
        let experiments = stepped_sine(&axis(ACTUATORS[0]), 3).experiments().to_vec();
        Measurement::new(metadata, experiments, Vec::new(), String::new()).unwrap()
    }

    #[test]
    fn the_same_velocity_has_a_position_and_an_acceleration() {
        let fitted = measured("N m", ResponseKind::Velocity, "rad/s");
        for (kind, unit) in [
            (ResponseKind::Velocity, "rad/s"),
            (ResponseKind::Position, "rad"),
            (ResponseKind::Acceleration, "rad/s^2"),
            (ResponseKind::Acceleration, "rad/s²"),
        ] {
            let here = measured("N·m", kind, unit);
            assert_eq!(
                UnitCompatibility::between(&fitted, &here),
                UnitCompatibility::Same,
                "{unit}"
            );
        }
    }

    #[test]
    fn units_that_contradict_are_named_and_what_is_not_said_contradicts_nothing() {
        let fitted = measured("A", ResponseKind::Velocity, "m/s");
        let found = |input: &str, kind, unit: &str| {
            UnitCompatibility::between(&fitted, &measured(input, kind, unit))
        };
        let different = |quantity, fitted: &str, here: &str| UnitCompatibility::Different {
            quantity,
            fitted: fitted.into(),
            here: here.into(),
        };
        let velocity = ResponseKind::Velocity;
        assert_eq!(found("V", velocity, "m/s"), different("input", "A", "V"));
        let position = ResponseKind::Position;
        assert_eq!(found("A", position, "mm"), different("velocity", "m/s", "mm/s"));
        assert_eq!(found("", velocity, "m/s"), UnitCompatibility::Unsaid { quantity: "input" });
        assert_eq!(found("A", position, ""), UnitCompatibility::Unsaid { quantity: "velocity" });
        let nothing = measured("", velocity, "");
        let neither = measured("", position, "");
        assert_eq!(UnitCompatibility::between(&nothing, &neither), UnitCompatibility::Same);
    }

    #[test]
    fn an_answer_knows_the_units_it_was_fitted_in() {
        for (input, unit) in [("A", "rad/s"), ("N m", "m/s"), ("", "")] {
            let measurement = measured(input, ResponseKind::Velocity, unit);
            let mut request = IdentifyRequest {
                plant: Some(PlantRequest { actuator_order: 0 }),
                ..IdentifyRequest::default()
            };
            request.options.network.enabled = false;
            request.options.colony.enabled = false;
            let answer = fit_base(&measurement, &request, &Silent).unwrap().identification;
            let same = UnitCompatibility::with_answer(&answer, &measurement);
            assert_eq!(same, UnitCompatibility::Same, "{:?}", fitted_in(&answer));
            let other = measured("kg", ResponseKind::Velocity, unit);
            let agreement = UnitCompatibility::with_answer(&answer, &other);
            assert_ne!(agreement, UnitCompatibility::Same, "{input}");
        }
    }
}
