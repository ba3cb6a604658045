//! The coordinates in which parameters are searched and refined.
//!
//! All coordinates are in the problem's own units (see `problem`): rates in ω_ref, torques in
//! u_ref, velocities in v_ref. Rates, gains and the damping ratio are searched as logarithms.
//! Friction levels are searched as they are, because a friction level can be 0.

mod plant_at_point;
mod unit_cube;

use crate::effects::Effect;

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

    /// Clamps a point to the bounds. NaN becomes the middle of the search range.
    pub fn clamp(&self, point: &mut [f64]) {
        for (i, value) in point.iter_mut().enumerate() {
            if value.is_nan() {
                *value = 0.5 * (self.search_lower[i] + self.search_upper[i]);
            }
            *value = value.clamp(self.lower[i], self.upper[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const PRIOR: Prior =
        Prior { omega_low: 0.1, omega_high: 10.0, moving_level: 0.5, largest_level: 1.0 };

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
