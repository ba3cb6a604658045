//! Units of parameters, from those of a measurement.

use crate::effects::Dimension;
use crate::measurement::{Measurement, ResponseKind};

/// The units from which those of the parameters are made.
#[derive(Debug)]
pub(crate) struct Units {
    pub input: String,
    pub velocity: String,
}

impl Units {
    /// The units that the upload states; placeholders for those it does not.
    pub fn of(measurement: &Measurement) -> Self {
        let metadata = measurement.metadata();
        let or =
            |unit: &str, name: &str| if unit.is_empty() { name.into() } else { unit.to_owned() };
        let response = or(&metadata.response.unit, "response");
        let velocity = match metadata.response_kind {
            ResponseKind::Velocity => response,
            ResponseKind::Position => format!("{response}/s"),
            ResponseKind::Acceleration => format!("{response}·s"),
        };
        Self { input: or(&metadata.input.unit, "input"), velocity }
    }

    /// The unit of a quantity, as a product of powers of the units of input, velocity and time. What
    /// is a velocity times a time is in the unit of the position, where that of the velocity names it.
    pub fn unit(&self, dimension: Dimension) -> String {
        let Dimension { input, velocity, time } = dimension;
        let position = self.velocity.strip_suffix("/s").filter(|_| velocity * time > 0);
        let motion = match position {
            Some(position) => [(position, velocity), ("s", time - velocity)],
            None => [(&*self.velocity, velocity), ("s", time)],
        };
        let powers = [(&*self.input, input), motion[0], motion[1]];
        let join = |sign: i8| -> Vec<String> {
            let wanted = powers.iter().filter(|(_, power)| power.signum() == sign);
            let is_product = wanted.clone().count() > 1;
            wanted
                .map(|(unit, power)| match power.abs() {
                    1 if is_product && unit.contains('/') => bracketed(unit),
                    1 => (*unit).to_owned(),
                    power => format!("{}{}", bracketed(unit), superscript(power)),
                })
                .collect()
        };
        match (join(1).as_slice(), join(-1).as_slice()) {
            ([], []) => String::new(),
            (above, []) => above.join("·"),
            ([], [below]) => format!("1/{}", bracketed(below)),
            ([], below) => format!("1/({})", below.join("·")),
            (above, [below]) => format!("{}/{}", bracketed(&above.join("·")), bracketed(below)),
            (above, below) => format!("{}/({})", bracketed(&above.join("·")), below.join("·")),
        }
    }
}

fn superscript(power: i8) -> &'static str {
    ["⁰", "¹", "²", "³", "⁴", "⁵"].get(power.unsigned_abs() as usize).unwrap_or(&"ⁿ")
}

/// A unit, bracketed for use in a quotient if it is a compound.
pub(super) fn bracketed(unit: &str) -> String {
    if unit.contains(['/', '·', '*', ' ']) { format!("({unit})") } else { unit.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(velocity: &str, dimension: Dimension) -> String {
        Units { input: "A".into(), velocity: velocity.into() }.unit(dimension)
    }

    #[test]
    fn a_velocity_times_a_second_is_in_the_unit_of_the_position() {
        let stiffness = Dimension::INPUT.per(Dimension::POSITION);
        assert_eq!(unit("rad/s", stiffness), "A/rad");
        assert_eq!(unit("rad/s", Dimension::POSITION), "rad");
        assert_eq!(unit("rad/s", Dimension { input: 1, velocity: -3, time: -3 }), "A/rad³");
        assert_eq!(unit("response", stiffness), "A/(response·s)");
    }

    #[test]
    fn a_quotient_in_a_product_stands_in_brackets() {
        let product = Dimension { input: 1, velocity: 1, time: 0 };
        assert_eq!(unit("rad/s", product), "A·(rad/s)");
        assert_eq!(unit("rad/s", Dimension::INPUT.per(Dimension::VELOCITY)), "A/(rad/s)");
        assert_eq!(unit("mm/min", Dimension::POSITION), "(mm/min)·s");
    }
}
