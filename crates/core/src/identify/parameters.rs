//! The coordinates in which parameters are searched and refined.
//!
//! All coordinates are in the problem's own units (see `problem`): rates in ω_ref, torques in
//! u_ref, velocities in v_ref. Rates, gains and the damping ratio are searched as logarithms.
//! Friction levels are searched as they are, because a friction level can be 0.

use crate::effects::{Effect, Wide};
use crate::plant::{Actuator, Friction, Plant, Scalar};

/// One searched parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coordinate {
    /// ln a.
    ViscousRate,
    /// ln K.
    Constant,
    /// Fc⁺.
    FcPlus,
    /// Fc⁻.
    FcMinus,
    /// (Fc⁺ + Fc⁻)/2, where the data hardly tells the levels apart.
    FcMean,
    /// ((Fc⁺ − Fc⁻)/(Fc⁺ + Fc⁻))², beside [`Self::FcMean`]. Odd harmonics of the response to a
    /// cosine are even functions of the difference, so that they change in proportion to its square.
    FcSplit,
    /// ln p of a first-order actuator.
    ActuatorRate,
    /// ln ωₙ.
    NaturalFrequency,
    /// ln ζ.
    DampingRatio,
    /// A parameter of an effect, or its logarithm: see `effect_coordinates`.
    OfEffect {
        /// Index of the effect.
        effect: usize,
        /// Index of its parameter.
        parameter: usize,
    },
}

/// The parameters that are searched, and their bounds.
#[derive(Debug, Clone)]
pub(super) struct Coordinates {
    /// The coordinates: K always at index [`CONSTANT`], those of effects last.
    pub list: Vec<Coordinate>,
    /// The effects of the model.
    pub effects: Vec<&'static dyn Effect>,
    /// Lower bounds: refinement stays within them.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    /// Lower ends of the ranges of a global search (the entry of K is unused: K is solved for).
    pub search_lower: Vec<f64>,
    /// Upper ends of the same ranges.
    pub search_upper: Vec<f64>,
}

/// Index of K in every vector of coordinates.
pub(super) const CONSTANT: usize = 1;

/// Largest actuator rate, as a multiple of the highest frequency. Such an actuator shifts the phase
/// at that frequency by only about 1e-4 rad, so a higher order never fits worse than a lower one.
const FASTEST_ACTUATOR_RATIO: f64 = 1e4;

/// Least damping ratio of an actuator: it amplifies its resonance 25 times. The loops and filters of
/// drives are damped by design; a sharper resonance is mechanical, and the effect `flexible_mode`
/// describes it. Without this limit a resonance between two lines can serve these alone.
const LEAST_DAMPING_RATIO: f64 = 0.02;

/// Range of [`Coordinate::FcSplit`]: the prior where the data hardly tells the levels apart. One
/// level is at most twice the other. The lower end, levels 2 % apart, keeps the square root
/// differentiable; the response there differs from that of equal levels by some 1e-5.
const SPLIT_RANGE: [f64; 2] = [1e-4, 1.0 / 9.0];

/// What the data says about where parameters can lie, in the problem's units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    /// Lowest frequency that was excited and observed.
    pub omega_low: f64,
    /// Highest such frequency.
    pub omega_high: f64,
    /// Smallest peak input at which an experiment showed motion.
    pub moving_level: f64,
    /// Largest peak input of all experiments.
    pub largest_level: f64,
}

impl Coordinates {
    /// Coordinates of the base model with an actuator of the given order.
    pub fn new(order: u8, tied_friction: bool, prior: &Prior) -> Self {
        let Prior { omega_low, omega_high, .. } = *prior;
        let mut these = Self {
            list: Vec::new(),
            effects: Vec::new(),
            lower: Vec::new(),
            upper: Vec::new(),
            search_lower: Vec::new(),
            search_upper: Vec::new(),
        };
        // A pole a factor of 30 outside the band has no measurable effect. The search covers the
        // band and a factor of 3 on either side.
        these.push_log(
            Coordinate::ViscousRate,
            [omega_low / 30.0, omega_high * 30.0],
            [omega_low / 3.0, omega_high * 3.0],
        );
        these.push_log(Coordinate::Constant, [1e-6, 1e6], [1.0, 1.0]);
        // If the axis moved, at least one friction level lies below the peak input of that
        // experiment. Levels much above the largest input all predict the same: no motion.
        let likely = [0.0, prior.moving_level];
        let frictions: &[Coordinate] = if tied_friction {
            &[Coordinate::FcMean]
        } else {
            &[Coordinate::FcPlus, Coordinate::FcMinus]
        };
        for coordinate in frictions {
            these.push(*coordinate, [0.0, 1.05 * prior.largest_level], likely);
        }
        if tied_friction {
            these.push(Coordinate::FcSplit, SPLIT_RANGE, SPLIT_RANGE);
        }
        match order {
            1 => these.push_log(
                Coordinate::ActuatorRate,
                [omega_low / 30.0, omega_high * FASTEST_ACTUATOR_RATIO],
                [omega_low / 3.0, omega_high * 10.0],
            ),
            2 => {
                these.push_log(
                    Coordinate::NaturalFrequency,
                    [omega_low / 10.0, omega_high * FASTEST_ACTUATOR_RATIO],
                    [omega_low, omega_high * 5.0],
                );
                these.push_log(
                    Coordinate::DampingRatio,
                    [LEAST_DAMPING_RATIO, 100.0],
                    [LEAST_DAMPING_RATIO, 2.0],
                );
            }
            _ => {}
        }
        these
    }

    fn push_log(&mut self, coordinate: Coordinate, bounds: [f64; 2], search: [f64; 2]) {
        self.push(coordinate, bounds.map(f64::ln), search.map(f64::ln));
    }

    pub(super) fn push(&mut self, coordinate: Coordinate, bounds: [f64; 2], search: [f64; 2]) {
        self.list.push(coordinate);
        self.lower.push(bounds[0]);
        self.upper.push(bounds[1]);
        self.search_lower.push(search[0]);
        self.search_upper.push(search[1]);
    }

    /// Number of coordinates.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Number of coordinates of the base model.
    pub fn base_len(&self) -> usize {
        let of_effect = |c: &Coordinate| matches!(c, Coordinate::OfEffect { .. });
        self.list.iter().position(of_effect).unwrap_or(self.list.len())
    }

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

    /// Clamps a point to the bounds. NaN becomes the middle of the search range.
    pub fn clamp(&self, point: &mut [f64]) {
        for (i, value) in point.iter_mut().enumerate() {
            if value.is_nan() {
                *value = 0.5 * (self.search_lower[i] + self.search_upper[i]);
            }
            *value = value.clamp(self.lower[i], self.upper[i]);
        }
    }

    /// Maps a vector of the unit cube to the search ranges of all coordinates but K, whose entry is
    /// left 0.
    pub fn within_search(&self, cube: &[f64]) -> Vec<f64> {
        let mut cube = cube.iter();
        (0..self.len())
            .map(|i| match i {
                CONSTANT => 0.0,
                _ => {
                    let share = cube.next().expect("one entry a coordinate but K");
                    self.search_lower[i] + share * (self.search_upper[i] - self.search_lower[i])
                }
            })
            .collect()
    }

    /// The inverse of [`Self::within_search`], clamped to the cube.
    pub fn share_of_search(&self, point: &[f64]) -> Vec<f64> {
        let shares = self.share_of_search_unclamped(point);
        shares.into_iter().map(|share| share.clamp(0.0, 1.0)).collect()
    }

    /// The inverse of [`Self::within_search`], not clamped: entries leave `[0, 1]` where the point
    /// lies outside the search ranges.
    pub fn share_of_search_unclamped(&self, point: &[f64]) -> Vec<f64> {
        (0..self.len())
            .filter(|i| *i != CONSTANT)
            .map(|i| {
                let width = self.search_upper[i] - self.search_lower[i];
                (point[i] - self.search_lower[i]) / width
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis};
    use super::*;

    const PRIOR: Prior =
        Prior { omega_low: 0.1, omega_high: 10.0, moving_level: 0.5, largest_level: 1.0 };

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

    #[test]
    fn the_cube_spans_the_search_range_and_leaves_k_out() {
        let coordinates = Coordinates::new(2, false, &PRIOR);
        let cube = [0.1, 0.3, 0.5, 0.7, 0.9];
        let point = coordinates.within_search(&cube);
        assert_eq!(point[CONSTANT], 0.0);
        for (share, wanted) in coordinates.share_of_search(&point).iter().zip(cube) {
            assert!((share - wanted).abs() < 1e-14);
        }
        let corner = coordinates.within_search(&[1.0; 5]);
        assert!((0..6).all(|i| i == CONSTANT || corner[i] <= coordinates.upper[i]));
    }

    #[test]
    fn a_point_outside_the_bounds_is_moved_onto_them() {
        let coordinates = Coordinates::new(0, false, &PRIOR);
        let mut point = vec![f64::NAN, f64::INFINITY, -3.0, 3.0];
        coordinates.clamp(&mut point);
        assert!(
            (point[0] - 0.5 * (coordinates.search_lower[0] + coordinates.search_upper[0])).abs()
                < 1e-14
        );
        assert_eq!(point[1..], [coordinates.upper[1], 0.0, 1.05]);
    }
}
