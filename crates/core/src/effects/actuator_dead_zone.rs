//! Actuator dead zone: the amplifier ignores small commands.
//!
//! u − clip(u, ±half_width) in place of u, before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;
use crate::plant::Scalar as _;

/// Parameter: the half width.
#[derive(Debug)]
pub struct ActuatorDeadZone;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "half_width",
    title: "half width of the dead zone",
    symbol: ["h", ""],
    dimension: Dimension::INPUT,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    range: |scope| Range {
        bounds: [0.0, 0.99 * scope.largest_level],
        likely: [0.0, 0.5 * scope.moving_level],
        absent: Some(0.0),
    },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "actuator_dead_zone",
    title: "actuator dead zone",
    with_article: "an actuator dead zone",
    equation: "u − clip(u, ±h), before A(s)",
    meaning: "small commands have no effect: the amplifier or valve has a dead zone around zero",
    signature: "a loss of fundamental and odd harmonics that matter most at the lowest magnitude, at \
         every frequency",
    imitators: &["static_friction", "stribeck"],
    slot: Slot::DeadZone,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| vec![scales.level() * draws.log_uniform(0.1, 0.5)],
        scaled: |scales, values, factor| Some(vec![up_to(values[0], factor, 0.9 * scales.lowest)?]),
        by_character: None,
    },
};

impl Effect for ActuatorDeadZone {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        let half_width = parameters[0];
        axis.add_input_map(InputMap {
            stage: Stage::DeadZone,
            breaks: vec![-half_width, half_width],
            slopes: [1.0, 0.0, 1.0].map(Wide::constant).to_vec(),
        });
    }
}
