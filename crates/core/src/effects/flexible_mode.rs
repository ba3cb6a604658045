//! A load behind an elastic joint.
//!
//! Motor and load share the inertia J = 1/K as (1 − ρ):ρ. With φ' = v − v_load:
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

/// ρ, k and c.
#[derive(Debug)]
pub struct FlexibleMode;

const PARAMETERS: [Parameter; 3] = [LOAD_INERTIA_FRACTION, STIFFNESS, DAMPING];

/// ρ.
pub(super) const LOAD_INERTIA_FRACTION: Parameter = Parameter {
    name: "load_inertia_fraction",
    title: "share of the inertia in the load",
    symbol: ["ρ", ""],
    dimension: Dimension::NONE,
    domain: Domain::Share,
    coordinate: Coordinate::Logarithmic,
    range: |_| Range { bounds: [1e-4, 0.99], likely: [3e-3, 0.7], absent: Some(0.0) },
};

/// k.
pub(super) const STIFFNESS: Parameter = Parameter {
    name: "stiffness",
    title: "stiffness of the joint",
    symbol: ["k", ""],
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // An antiresonance √(k/(ρJ)) from below the lowest frequency to far above
    // the highest, where the joint is rigid; of a small load with a small k.
    range: |scope| {
        let at = |omega: f64| omega * omega * load_inertia(scope);
        Range {
            bounds: [3e-4 * at(0.3 * scope.omega_low), at(30.0 * scope.omega_high)],
            likely: [at(scope.omega_low), at(3.0 * scope.omega_high)],
            absent: None,
        }
    },
};

/// c.
pub(super) const DAMPING: Parameter = Parameter {
    name: "damping",
    title: "damping of the joint",
    symbol: ["c", ""],
    dimension: Dimension::INPUT.per(Dimension::VELOCITY),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Logarithmic,
    // From next to nothing to more than critical in the middle of the band.
    range: |scope| {
        let middle = (scope.omega_low * scope.omega_high).sqrt() * load_inertia(scope);
        Range {
            bounds: [1e-7 * middle, 100.0 * middle],
            likely: [0.01 * middle, 3.0 * middle],
            absent: None,
        }
    },
};

/// Inertia of a load that has a third of the whole.
fn load_inertia(scope: &Scope) -> f64 {
    0.3 / scope.plant.constant.abs()
}

/// ρ of the loads that are tried first.
const LIGHT: f64 = 0.1;

/// Damping ratios that are tried.
const DAMPING_RATIOS: [f64; 4] = [0.02, 0.07, 0.25, 0.8];

/// By how much a frequency that is tried is larger than the one before, as a share of it, of a
/// joint that is hardly damped: what is damped more shows as much farther.
const NEXT: f64 = 0.08;

/// Light loads that swing behind the joint at √(k/(ρJ)), over the band and up to where
/// harmonics may still show it. A coarse grid of k misses what is little damped, most of all
/// beside the actuator's own frequency, which takes up much of what it sees of it.
fn resonances(scope: &Scope) -> Vec<Vec<f64>> {
    let inertia = LIGHT / scope.plant.constant.abs();
    let damped = |ratio: f64| {
        let place =
            move |omega: f64| vec![LIGHT, inertia * omega * omega, 2.0 * ratio * inertia * omega];
        std::iter::successors(Some(scope.omega_low), move |omega| {
            Some(omega * (1.0 + NEXT + ratio))
        })
        .take_while(|omega| *omega < 3.0 * scope.omega_high)
        .map(place)
    };
    DAMPING_RATIOS.into_iter().flat_map(damped).collect()
}

/// Makes a load (ρ, k, c, …) so many times as heavy, its motion beside the motor's
/// as it was.
pub(super) fn resize_load(values: &mut [f64], _ranges: &[Range], factor: f64) {
    values.iter_mut().take(3).for_each(|value| *value *= factor);
}

/// Draws ρ from 0.2 to 0.6, k and c by the resonance (2 a to 10 a) of motor against load and its
/// damping ratio, which lies in `ratios`.
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

/// A load `factor` times as heavy, up to ρ = 0.85, at the same resonance and damping ratio.
pub(super) fn heavier_load(_: &MachineScales, values: &[f64], factor: f64) -> Option<Vec<f64>> {
    let mut values = values.to_vec();
    let fraction = values[0];
    values[0] = up_to(fraction, factor, 0.85)?;
    let inertias = values[0] * (1.0 - values[0]) / (fraction * (1.0 - fraction));
    values[1] *= inertias;
    values[2] *= inertias;
    Some(values)
}

/// A joint `factor` times as soft at the same damping ratio, down to a resonance at a/2.
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
        starts: Starts::Points(resonances),
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
