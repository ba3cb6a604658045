//! The plant at a point, and the point of a plant.

use super::{Coordinate, Coordinates};
use crate::effects::Wide;
use crate::plant::{Actuator, Friction, Plant, Scalar};

impl Coordinates {
    /// The plant at a point, in the problem's units.
    pub fn plant(&self, point: &[f64]) -> Plant {
        self.plant_of(point)
    }

    /// The plant as dual numbers: coordinate i of the base model is the variable in lane i.
    pub fn variable_plant(&self, point: &[f64]) -> Plant<Wide> {
        let variables: Vec<Wide> = point[..self.base_len()]
            .iter()
            .enumerate()
            .map(|(i, value)| Wide::variable(*value, i))
            .collect();
        self.plant_of(&variables)
    }

    fn plant_of<S: Scalar>(&self, point: &[S]) -> Plant<S> {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let mut plant = Plant {
            viscous_rate_rad_s: one,
            constant: one,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(zero, zero),
        };
        let (mut fc_plus, mut fc_minus) = (zero, zero);
        let mut wn = one;
        for (coordinate, value) in self.list.iter().zip(point) {
            match coordinate {
                Coordinate::ViscousRate => plant.viscous_rate_rad_s = value.exp(),
                Coordinate::Constant => plant.constant = value.exp(),
                Coordinate::FcPlus => fc_plus = *value,
                Coordinate::FcMinus => fc_minus = *value,
                Coordinate::FcMean => (fc_plus, fc_minus) = (*value, *value),
                Coordinate::FcSplit => {
                    let half_difference = fc_plus * value.sqrt();
                    (fc_plus, fc_minus) = (fc_plus + half_difference, fc_minus - half_difference);
                }
                Coordinate::ActuatorRate => {
                    plant.actuator = Actuator::FirstOrder { corner_rad_s: value.exp() };
                }
                Coordinate::NaturalFrequency => wn = value.exp(),
                Coordinate::DampingRatio => {
                    plant.actuator = Actuator::SecondOrder {
                        natural_frequency_rad_s: wn,
                        damping_ratio: value.exp(),
                    };
                }
                Coordinate::OfEffect { .. } => {}
            }
        }
        plant.friction = Friction::coulomb(fc_plus, fc_minus);
        plant
    }

    /// The coordinates of a plant, clamped to the bounds. Coordinates of effects are set to the
    /// middle of their search range.
    pub fn point(&self, plant: &Plant) -> Vec<f64> {
        let friction = plant.friction;
        let (first, second) = match plant.actuator {
            Actuator::Direct => (1.0, 1.0),
            Actuator::FirstOrder { corner_rad_s } => (corner_rad_s, 1.0),
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                (natural_frequency_rad_s, damping_ratio)
            }
        };
        let mut point: Vec<f64> = self
            .list
            .iter()
            .map(|coordinate| match coordinate {
                Coordinate::ViscousRate => plant.viscous_rate_rad_s.ln(),
                Coordinate::Constant => plant.constant.ln(),
                Coordinate::FcPlus => friction.fc_plus,
                Coordinate::FcMinus => friction.fc_minus,
                Coordinate::FcMean => 0.5 * (friction.fc_plus + friction.fc_minus),
                // Without friction this is NaN, which `clamp` replaces.
                Coordinate::FcSplit => {
                    let difference = friction.fc_plus - friction.fc_minus;
                    (difference / (friction.fc_plus + friction.fc_minus)).powi(2)
                }
                Coordinate::ActuatorRate | Coordinate::NaturalFrequency => first.ln(),
                Coordinate::DampingRatio => second.ln(),
                // A plant contains no effects: `clamp` replaces NaN by the middle of the search
                // range.
                Coordinate::OfEffect { .. } => f64::NAN,
            })
            .collect();
        self.clamp(&mut point);
        point
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::PRIOR;
    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis};
    use crate::identify::parameters::Prior;

    #[test]
    fn a_plant_survives_the_way_to_a_point_and_back() {
        for actuator in ACTUATORS {
            let plant = axis(actuator);
            let wide = Prior { omega_high: 100.0, ..PRIOR };
            let coordinates = Coordinates::new(actuator.order(), false, &wide);
            let back = coordinates.plant(&coordinates.point(&plant));
            assert!((back.viscous_rate_rad_s / 10.0 - 1.0).abs() < 1e-14);
            assert!((back.constant / 10.0 - 1.0).abs() < 1e-14);
            assert_eq!(back.friction, plant.friction);
            assert!((back.actuator.response(7.0) - actuator.response(7.0)).norm() < 1e-14);
        }
    }

    #[test]
    fn tied_levels_are_a_mean_and_the_square_of_a_relative_difference() {
        let coordinates = Coordinates::new(0, true, &PRIOR);
        let point = coordinates.point(&axis(ACTUATORS[0]));
        assert!((point[2] - 0.45).abs() < 1e-14 && (point[3] - 1.0 / 81.0).abs() < 1e-14);
        let friction = coordinates.plant(&point).friction;
        assert!((friction.fc_plus - 0.5).abs() < 1e-14 && (friction.fc_minus - 0.4).abs() < 1e-14);
        let mut without = axis(ACTUATORS[0]);
        without.friction = Friction::coulomb(0.0, 0.0);
        let friction = coordinates.plant(&coordinates.point(&without)).friction;
        assert_eq!(friction, Friction::coulomb(0.0, 0.0));
    }
}
