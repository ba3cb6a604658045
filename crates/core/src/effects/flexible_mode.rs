//! Flexible mode: a load behind an elastic joint (two-mass system).
//!
//! Motor and load split the inertia J = 1/K as (1 − ρ):ρ. A spring k and a damper c join them; φ is
//! the twist of the joint, φ' = v − v_load:
//! (1 − ρ)J·v' = −(a/K)·v + τ − f − T_s, ρJ·v_load' = T_s,
//! T_s = k·φ + c·(v − v_load). y is the motor's velocity.

use super::axis::{Axis, SecondMass, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, Draws, MachineScales, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range, Scope};
use super::search_plan::{SearchPlan, Starts};
use super::slot::Slot;
use crate::plant::Scalar as _;

/// Parameters: ρ, k and c.
#[derive(Debug)]
pub struct FlexibleMode;

const PARAMETERS: [Parameter; 3] = [LOAD_INERTIA_FRACTION, STIFFNESS, DAMPING];

/// ρ, the load's share of the inertia.
pub(super) const LOAD_INERTIA_FRACTION: Parameter = Parameter {
    name: "load_inertia_fraction",
    title: "share of the inertia in the load",
    symbol: ["ρ", ""],
    dimension: Dimension::NONE,
    domain: Domain::Share,
    coordinate: Coordinate::Logarithmic,
    range: |_| Range { bounds: [1e-4, 0.99], likely: [3e-3, 0.7], absent: Some(0.0) },
};

/// k, the stiffness of the joint.
pub(super) const STIFFNESS: Parameter = Parameter {
    name: "stiffness",
    title: "stiffness of the joint",
    symbol: ["k", ""],
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // The antiresonance √(k/(ρJ)) lies from below the lowest frequency to far above the highest,
    // where the joint is rigid. The factor 3e-4 allows for light loads (ρ = 1e-4 instead of 0.3).
    range: |scope| {
        let at = |omega: f64| omega * omega * load_inertia(scope);
        Range {
            bounds: [3e-4 * at(0.3 * scope.omega_low), at(30.0 * scope.omega_high)],
            likely: [at(scope.omega_low), at(3.0 * scope.omega_high)],
            absent: None,
        }
    },
};

/// c, the damping of the joint.
pub(super) const DAMPING: Parameter = Parameter {
    name: "damping",
    title: "damping of the joint",
    symbol: ["c", ""],
    dimension: Dimension::INPUT.per(Dimension::VELOCITY),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Logarithmic,
    // From little to more than critical damping (c = 2·ρJ·ω) in the middle of the band.
    range: |scope| {
        let middle = (scope.omega_low * scope.omega_high).sqrt() * load_inertia(scope);
        let least = if scope.has_spectra { LEAST_DAMPING_ON_RECORDS } else { 1e-7 };
        Range {
            bounds: [least * middle, 100.0 * middle],
            likely: [0.01 * middle, 3.0 * middle],
            absent: None,
        }
    },
};

/// No joint is without damping, and a resonance without it serves a few lines of a spectrum and nothing
/// else. In a table every frequency is an experiment, and light loads with little damping show. Set by
/// hand.
const LEAST_DAMPING_ON_RECORDS: f64 = 1e-3;

/// Inertia ρJ of a load with ρ = 0.3.
fn load_inertia(scope: &Scope) -> f64 {
    0.3 / scope.plant.constant.abs()
}

/// ρ of all starting points.
const START_LOAD_FRACTION: f64 = 0.1;

/// Starting values of the damping ratio of the joint.
const DAMPING_RATIOS: [f64; 4] = [0.02, 0.07, 0.25, 0.8];

/// Relative step between starting values of the antiresonance without damping. The damping ratio is
/// added to it, as damping widens the antiresonance. Tuned.
const FREQUENCY_STEP: f64 = 0.08;

/// Starting points with antiresonances √(k/(ρJ)) over the band and up to three times its upper end,
/// where harmonics may still show them. A coarse grid of k misses a lightly damped one, above all
/// near the actuator's natural frequency, where the actuator's parameters absorb much of it.
fn start_points(scope: &Scope) -> Vec<Vec<f64>> {
    let inertia = START_LOAD_FRACTION / scope.plant.constant.abs();
    let damped = |ratio: f64| {
        let start_point = move |omega: f64| {
            vec![START_LOAD_FRACTION, inertia * omega * omega, 2.0 * ratio * inertia * omega]
        };
        std::iter::successors(Some(scope.omega_low), move |omega| {
            Some(omega * (1.0 + FREQUENCY_STEP + ratio))
        })
        .take_while(|omega| *omega < 3.0 * scope.omega_high)
        .map(start_point)
    };
    DAMPING_RATIOS.into_iter().flat_map(damped).collect()
}

/// Multiplies ρ, k and c by `factor`: a heavier load, with the same motion relative to the motor.
pub(super) fn resize_load(values: &mut [f64], _ranges: &[Range], factor: f64) {
    values.iter_mut().take(3).for_each(|value| *value *= factor);
}

/// Draws ρ from 0.2 to 0.6, and k and c from the resonance of motor against load (2·a to 10·a) and
/// its damping ratio (`low` to `high`).
pub(super) fn draw_joint(
    scales: &MachineScales,
    draws: &mut dyn Draws,
    [low, high]: [f64; 2],
) -> [f64; 3] {
    let load = draws.log_uniform(0.2, 0.6);
    let resonance = scales.viscous_rate * draws.log_uniform(2.0, 10.0);
    let inertia = load * (1.0 - load) / scales.constant;
    let stiffness = resonance * resonance * inertia;
    let per_ratio = 2.0 * resonance * inertia;
    [load, stiffness, per_ratio * draws.log_uniform(low, high)]
}

/// The joint with ρ `factor` times as large, up to 0.85, and the same resonance and damping ratio.
pub(super) fn heavier_load(_: &MachineScales, values: &[f64], factor: f64) -> Option<Vec<f64>> {
    let mut values = values.to_vec();
    let fraction = values[0];
    values[0] = up_to(fraction, factor, 0.85)?;
    let inertias = values[0] * (1.0 - values[0]) / (fraction * (1.0 - fraction));
    values[1] *= inertias;
    values[2] *= inertias;
    Some(values)
}

/// The joint with k divided by `factor` and the same damping ratio; `None` if its resonance is
/// below a/2.
pub(super) fn softer_joint(
    scales: &MachineScales,
    values: &[f64],
    factor: f64,
) -> Option<Vec<f64>> {
    let mut values = values.to_vec();
    let (fraction, stiffness) = (values[0], values[1]);
    let resonance = (scales.constant * stiffness / (factor * fraction * (1.0 - fraction))).sqrt();
    values[1] /= factor;
    values[2] /= factor.sqrt();
    (resonance >= 0.5 * scales.viscous_rate).then_some(values)
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "flexible_mode",
    title: "flexible mode",
    with_article: "a flexible mode",
    equation: "(1 − ρ)J·v' = −(a/K)·v + τ − f − T_s, ρJ·v_load' = T_s, T_s = k·φ + c·(v − v_load), φ' = v − v_load, J = 1/K",
    meaning: "the load hangs on an elastic joint (shaft, belt or coupling) and swings against \
         the motor",
    signature: "an antiresonance and a resonance in the fundamental, the same at every magnitude",
    imitators: &["backlash", "spring", "sensor_lag"],
    slot: Slot::SecondMass,
    parameters: &PARAMETERS,
    search: SearchPlan {
        starts: Starts::Points(start_points),
        resize: resize_load,
        ..SearchPlan::DEFAULT
    },
    draw: DrawPlan {
        draw: |scales, draws| draw_joint(scales, draws, [0.01, 0.3]).to_vec(),
        scaled: heavier_load,
        by_character: Some(softer_joint),
    },
};

impl Effect for FlexibleMode {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.second_mass = Some(SecondMass {
            load_inertia_fraction: parameters[0],
            stiffness: parameters[1],
            damping: parameters[2],
            gap: Wide::constant(0.0),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{Actuator, Friction, Plant};

    #[test]
    fn a_joint_may_have_far_less_damping_in_a_table_than_on_a_record() {
        let least = |has_spectra: bool| {
            let scope = Scope {
                plant: Plant {
                    viscous_rate_rad_s: 10.0,
                    constant: 10.0,
                    actuator: Actuator::Direct,
                    friction: Friction::coulomb(0.5, 0.4),
                },
                omega_low: 1.0,
                omega_high: 100.0,
                has_spectra,
                moving_level: 1.0,
                largest_level: 4.0,
                steepest_input: 400.0,
                largest_velocity: 3.5,
                largest_travel: 3.5,
            };
            (DAMPING.range)(&scope).bounds[0]
        };
        // A thousandth of ρJ·ω, with ρ = 0.3, J = 0.1 and ω = 10 rad/s.
        assert!((least(true) / 3e-4 - 1.0).abs() < 1e-12);
        assert!(least(false) < 1e-3 * least(true));
    }
}
