//! Backlash: play between motor and load.
//!
//! As in `flexible_mode`, a spring k and a damper c join motor and load, but they act only while
//! the twist φ (φ' = v − v_load) is outside ±gap/2: T_s = k·(φ beyond the gap) + c·(v − v_load) in
//! contact, 0 inside the gap. T_s is not clipped: it may pull just before contact ends. y is the
//! motor's velocity.

use super::axis::{Axis, SecondMass, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::DrawPlan;
use super::effect::Effect;
use super::flexible_mode::{
    DAMPING, LOAD_INERTIA_FRACTION, STIFFNESS, draw_joint, heavier_load, resize_load, softer_joint,
};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range, Scope};
use super::search_plan::{SearchPlan, Starts};
use super::slot::Slot;

/// Parameters: ρ, k, c and the gap.
#[derive(Debug)]
pub struct Backlash;

const PARAMETERS: [Parameter; 4] = [LOAD_INERTIA_FRACTION, STIFFNESS, DAMPING, GAP];

const GAP: Parameter = Parameter {
    name: "gap",
    title: "gap of the joint",
    symbol: ["ε", ""],
    dimension: Dimension::POSITION,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Logarithmic,
    range: |scope| Range {
        bounds: [1e-6, 2.0].map(|share| share * scope.largest_travel),
        likely: [1e-4, 0.1].map(|share| share * scope.largest_travel),
        absent: None,
    },
};

/// Starting values of ρ. The effect is not proportional to ρ: a light load and a heavy one lead a
/// fit to different gaps.
const LOADS: [f64; 2] = [0.1, 0.3];

/// Starting values of the damping ratio in contact.
const DAMPING_RATIOS: [f64; 2] = [0.05, 0.4];

/// Starting values of the gap, as shares of the largest travel.
const GAPS: [f64; 3] = [3e-4, 3e-3, 3e-2];

/// Ratio of successive starting values of the resonance in contact.
const FREQUENCY_RATIO: f64 = 3.0;

/// Starting points with resonances √(k/(ρ(1 − ρ)J)) of motor against load in contact from within
/// the band to ten times its upper end. There a contact is an impact; only its damping ratio
/// matters.
fn start_points(scope: &Scope) -> Vec<Vec<f64>> {
    let start_point = |load: f64, omega: f64, ratio: f64, gap: f64| {
        let inertia = load * (1.0 - load) / scope.plant.constant.abs();
        let (stiffness, damping) = (inertia * omega * omega, 2.0 * ratio * inertia * omega);
        vec![load, stiffness, damping, gap * scope.largest_travel]
    };
    std::iter::successors(Some(2.0 * scope.omega_low), |omega| Some(FREQUENCY_RATIO * omega))
        .take_while(|omega| *omega < 10.0 * scope.omega_high)
        .flat_map(|omega| LOADS.map(|load| (omega, load)))
        .flat_map(|(omega, load)| DAMPING_RATIOS.map(|ratio| (omega, load, ratio)))
        .flat_map(|(omega, load, ratio)| GAPS.map(|gap| start_point(load, omega, ratio, gap)))
        .collect()
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "backlash",
    title: "backlash",
    with_article: "backlash",
    equation: "(1 − ρ)J·v' = −(a/K)·v + τ − f − T_s, ρJ·v_load' = T_s, φ' = v − v_load, J = 1/K; T_s = k·(φ beyond ±ε/2) + c·(v − v_load) in contact, 0 inside the gap ε",
    meaning: "there is play between motor and load: at every reversal the motor crosses a gap \
         alone",
    signature: "impacts after every reversal: harmonics of high order, even ones and a mean where \
         friction is asymmetric; above the resonance of the contact the axis responds as if it \
         were lighter, most at small magnitudes",
    imitators: &["flexible_mode"],
    slot: Slot::SecondMass,
    parameters: &PARAMETERS,
    search: SearchPlan {
        starts: Starts::Points(start_points),
        resize: resize_load,
        // Nobody builds a machine with so small a gap on purpose, and wear widens it.
        rare_when_small: Some(3),
        ..SearchPlan::DEFAULT
    },
    draw: DrawPlan {
        draw: |scales, draws| {
            let [load, stiffness, damping] = draw_joint(scales, draws, [0.05, 0.5]);
            vec![load, stiffness, damping, scales.travel() * draws.log_uniform(0.001, 0.3)]
        },
        scaled: heavier_load,
        by_character: Some(softer_joint),
    },
};

impl Effect for Backlash {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.second_mass = Some(SecondMass {
            load_inertia_fraction: parameters[0],
            stiffness: parameters[1],
            damping: parameters[2],
            gap: parameters[3],
        });
    }
}
