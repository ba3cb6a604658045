//! An amplifier that ignores small commands.
//!
//! u − clip(u, ±half_width), before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;
use crate::plant::Scalar as _;

/// The half width.
#[derive(Debug)]
pub struct ActuatorDeadZone;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "half_width",
    dimension: Dimension::INPUT,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    range: |scope| Range {
        bounds: [0.0, 0.99 * scope.largest_level],
        likely: [0.0, 0.5 * scope.moving_level],
        absent: Some(0.0),
    },
}];

impl Effect for ActuatorDeadZone {
    fn id(&self) -> &'static str {
        "actuator_dead_zone"
    }

    fn meaning(&self) -> &'static str {
        "small commands have no effect: the amplifier or valve has a dead zone around zero"
    }

    fn signature(&self) -> &'static str {
        "a loss of fundamental and odd harmonics that matter most at the lowest magnitude, at \
         every frequency"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["static_friction", "stribeck"]
    }

    fn slot(&self) -> Slot {
        Slot::DeadZone
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
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
