//! Stribeck friction: friction falls as the axis gains speed (Stribeck 1902).
//!
//! f(v) = sgn(v)·Fc·[1 + (r − 1)·exp(−(v/vs)²)], with breakaway at r·Fc. r is the ratio of static
//! to Coulomb friction, vs the Stribeck velocity.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, MachineScales, up_to};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameters: r and vs.
#[derive(Debug)]
pub struct Stribeck;

const PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "fs_over_fc",
        title: "ratio of static to dry friction",
        symbol: ["r", ""],
        dimension: Dimension::NONE,
        domain: Domain::AtLeastOne,
        coordinate: Coordinate::Linear,
        range: |_| Range { bounds: [0.2, 20.0], likely: [1.05, 2.5], absent: Some(1.0) },
    },
    Parameter {
        name: "stribeck_velocity",
        title: "Stribeck velocity",
        symbol: ["v", "s"],
        dimension: Dimension::VELOCITY,
        domain: Domain::Positive,
        coordinate: Coordinate::Logarithmic,
        // With vs below 1e-4 of the largest velocity the curve acts like static friction, with vs
        // far above it like a change of the Coulomb level.
        range: |scope| Range {
            bounds: [1e-4, 3.0].map(|share| share * scope.largest_velocity),
            likely: [0.01, 0.5].map(|share| share * scope.largest_velocity),
            absent: None,
        },
    },
];

/// The factor 1 + (r − 1)·exp(−(v/vs)²) on the Coulomb friction.
#[derive(Debug)]
struct Curve;

impl Form for Curve {
    fn at(&self, [r, vs, _]: &[f64; LAW_PARAMETERS], velocity: f64, _position: f64) -> Partials {
        let share = velocity / vs;
        let bump = (-share * share).exp();
        let slope = (r - 1.0) * bump * 2.0 * share / vs;
        Partials {
            value: 1.0 + (r - 1.0) * bump,
            by_velocity: -slope,
            by_position: 0.0,
            by_parameter: [bump, slope * share, 0.0],
        }
    }

    fn velocity_scale(&self, [_, vs, _]: &[f64; LAW_PARAMETERS]) -> Option<f64> {
        Some(*vs)
    }

    fn uses_position(&self) -> bool {
        false
    }

    fn contracts(&self) -> bool {
        false
    }
}

/// The curve with vs `factor` times as large; `None` above the velocity scale V of the machine.
fn faster(scales: &MachineScales, values: &[f64], factor: f64) -> Option<Vec<f64>> {
    let stribeck_velocity = factor * values[1];
    (stribeck_velocity <= scales.velocity()).then(|| vec![values[0], stribeck_velocity])
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "stribeck",
    title: "Stribeck friction",
    with_article: "Stribeck friction",
    equation: "f = sgn(v)·Fc·[1 + (r − 1)·exp(−(v/vs)²)], breakaway at r·Fc",
    meaning: "friction falls as the axis gains speed, as in a bearing, guide or seal with mixed \
         lubrication",
    signature: "strongest at the lowest magnitude and lowest frequencies, in the odd harmonics; fades as \
         the magnitude grows",
    imitators: &["static_friction", "quadratic_drag", "presliding"],
    slot: Slot::FrictionCurve,
    parameters: &PARAMETERS,
    search: SearchPlan {
        // Most data cannot tell a narrower curve from static friction with the same Fs/Fc in both
        // directions.
        rare_when_small: Some(1),
        ..SearchPlan::DEFAULT
    },
    draw: DrawPlan {
        draw: |scales, draws| {
            vec![draws.log_uniform(1.1, 1.8), scales.velocity() * draws.log_uniform(0.03, 0.5)]
        },
        scaled: |_, values, factor| {
            Some(vec![1.0 + up_to(values[0] - 1.0, factor, 2.0)?, values[1]])
        },
        by_character: Some(faster),
    },
};

impl Effect for Stribeck {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.friction_curve = Some(Law::new(&Curve, parameters));
    }
}
