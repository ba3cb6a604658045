//! The parameter names that a user sees.

use indexmap::IndexMap;

use crate::plant::{Actuator, Plant};

use super::parameters::{Coordinate, Coordinates};

/// Parameters of a plant by name, in the units of the plant.
pub(super) fn values(plant: &Plant) -> IndexMap<String, f64> {
    let mut values = IndexMap::new();
    let mut insert = |name: &str, value: f64| {
        values.insert(name.to_owned(), value);
    };
    insert("pole", -plant.viscous_rate_rad_s);
    insert("constant", plant.constant);
    insert("dc_gain", plant.constant / plant.viscous_rate_rad_s);
    insert("fc_plus", plant.friction.fc_plus);
    insert("fc_minus", plant.friction.fc_minus);
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => insert("actuator_pole", -corner_rad_s),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            insert("natural_frequency", natural_frequency_rad_s);
            insert("damping_ratio", damping_ratio);
        }
    }
    values
}

/// The name of the parameter at coordinate `i`; for an effect it is `effect.parameter`.
pub(super) fn name(coordinates: &Coordinates, i: usize) -> String {
    let base = match coordinates.list[i] {
        Coordinate::ViscousRate => "pole",
        Coordinate::Constant => "constant",
        Coordinate::FcPlus => "fc_plus",
        Coordinate::FcMinus => "fc_minus",
        Coordinate::FcMean => "fc_mean",
        Coordinate::FcSplit => "fc_split",
        Coordinate::ActuatorRate => "actuator_pole",
        Coordinate::NaturalFrequency => "natural_frequency",
        Coordinate::DampingRatio => "damping_ratio",
        Coordinate::OfEffect { effect, parameter } => {
            let effect = coordinates.effects[effect];
            return effect.key(&effect.parameters()[parameter]);
        }
    };
    base.to_owned()
}
