//! The directions along which a motion is differentiated: the parameters of the base model, and changes
//! of its input.

use crate::effects::Wide;
use crate::measurement::Complex;
use crate::plant::{Actuator, Friction, Plant, Scalar};

use crate::simulate::base::switching_times::Motion;
use crate::simulate::signal::excitation::Excitation;

/// A direction of differentiation: how fast parameters and torque lines change along it.
pub(crate) struct Direction {
    pub(super) viscous_rate: f64,
    pub(super) fc_plus: f64,
    pub(super) fc_minus: f64,
    fs_plus: f64,
    fs_minus: f64,
    /// Change of the torque lines; empty if they do not change.
    pub(super) lines: Vec<Complex>,
}

impl Direction {
    fn none() -> Self {
        Self {
            viscous_rate: 0.0,
            fc_plus: 0.0,
            fc_minus: 0.0,
            fs_plus: 0.0,
            fs_minus: 0.0,
            lines: Vec::new(),
        }
    }

    /// The direction in which the input changes by `deviation` (δU₀, δU₁ …).
    pub fn of_input(plant: &Plant, excitation: &Excitation, deviation: &[Complex]) -> Self {
        Self { lines: excitation.through(&plant.actuator, deviation), ..Self::none() }
    }

    /// Whether the motion changes along it; the static levels matter only if the axis `sticks`.
    pub(super) fn moves(&self, sticks: bool) -> bool {
        let Self { viscous_rate, fc_plus, fc_minus, fs_plus, fs_minus, lines } = self;
        let sliding = [viscous_rate, fc_plus, fc_minus].iter().any(|rate| **rate != 0.0);
        sliding || !lines.is_empty() || sticks && (*fs_plus != 0.0 || *fs_minus != 0.0)
    }

    /// Change of the friction while sliding.
    pub(super) fn sliding(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Forward => self.fc_plus,
            Motion::Backward => -self.fc_minus,
            Motion::Stuck => 0.0,
        }
    }

    /// Change of the torque at which a motion starts from rest.
    pub(super) fn breakaway(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Forward => self.fs_plus,
            Motion::Backward => -self.fs_minus,
            Motion::Stuck => 0.0,
        }
    }
}

/// Derivatives of the torque lines by the actuator's parameters (p; or ωₙ and ζ), in this order.
pub(crate) fn actuator_derivatives(
    actuator: &Actuator,
    excitation: &Excitation,
) -> Vec<Vec<Complex>> {
    let lines = |derivative: &dyn Fn(f64) -> Complex| {
        let input = excitation.input().iter().enumerate();
        input.map(|(l, u)| u * derivative(l as f64 * excitation.omega_rad_s())).collect()
    };
    match *actuator {
        Actuator::Direct => vec![],
        Actuator::FirstOrder { corner_rad_s: p } => {
            // A = p/(s + p), ∂A/∂p = s/(s + p)².
            let by_corner = |omega: f64| {
                let s_plus_p = Complex::new(p, omega);
                Complex::new(0.0, omega) / (s_plus_p * s_plus_p)
            };
            vec![lines(&by_corner)]
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            // A = ωₙ²/D, D = s² + 2ζωₙs + ωₙ².
            let denominator =
                |omega: f64| Complex::new(wn * wn - omega * omega, 2.0 * zeta * wn * omega);
            let by_frequency = |omega: f64| {
                let d = denominator(omega);
                (2.0 * wn * d - wn * wn * Complex::new(2.0 * wn, 2.0 * zeta * omega)) / (d * d)
            };
            let by_damping = |omega: f64| {
                let d = denominator(omega);
                -wn * wn * Complex::new(0.0, 2.0 * wn * omega) / (d * d)
            };
            vec![lines(&by_frequency), lines(&by_damping)]
        }
    }
}

/// One direction for each of a, Fc⁺, Fc⁻, Fs⁺, Fs⁻ and two parameters of the actuator (p; or ωₙ and
/// ζ), zero for those that it does not have.
pub(crate) fn parameter_directions(plant: &Plant, excitation: &Excitation) -> Vec<Direction> {
    let mut actuator = actuator_derivatives(&plant.actuator, excitation).into_iter();
    let mut by_actuator =
        || Direction { lines: actuator.next().unwrap_or_default(), ..Direction::none() };
    vec![
        Direction { viscous_rate: 1.0, ..Direction::none() },
        Direction { fc_plus: 1.0, ..Direction::none() },
        Direction { fc_minus: 1.0, ..Direction::none() },
        Direction { fs_plus: 1.0, ..Direction::none() },
        Direction { fs_minus: 1.0, ..Direction::none() },
        by_actuator(),
        by_actuator(),
    ]
}

/// Chain rule: derivatives of the harmonics by every lane of a plant. `by_number` are the derivatives
/// by the plant's numbers, in the order of [`parameter_directions`]; empty where they are 0.
pub(crate) fn by_lane(
    plant: &Plant<Wide>,
    velocity: &[Complex],
    by_number: &[Vec<Complex>],
    lanes: usize,
) -> Vec<Vec<Complex>> {
    let Plant { viscous_rate_rad_s, constant, actuator, friction } = plant;
    let (first, second) = match actuator {
        Actuator::Direct => (None, None),
        Actuator::FirstOrder { corner_rad_s } => (Some(corner_rad_s), None),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            (Some(natural_frequency_rad_s), Some(damping_ratio))
        }
    };
    let Friction { fc_plus, fc_minus, fs_plus, fs_minus } = friction;
    let levels = [fc_plus, fc_minus, fs_plus, fs_minus].map(Some);
    let numbers = [Some(viscous_rate_rad_s)].into_iter().chain(levels).chain([first, second]);
    let along_lane = |lane: usize| {
        // The response is proportional to K.
        let by_constant = constant.lane(lane) / constant.value();
        let mut row: Vec<Complex> = velocity.iter().map(|v| v * by_constant).collect();
        for (number, derivatives) in numbers.clone().zip(by_number) {
            let slope = number.map_or(0.0, |number| number.lane(lane));
            if slope != 0.0 {
                row.iter_mut().zip(derivatives).for_each(|(sum, d)| *sum += d * slope);
            }
        }
        row
    };
    (0..lanes).map(along_lane).collect()
}
