//! Actuator saturation: the amplifier clips the command.
//!
//! u is clipped to ±limit, before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, lowered};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;
use crate::plant::Scalar as _;

/// Parameter: the limit.
#[derive(Debug)]
pub struct ActuatorSaturation;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "limit",
    title: "limit of the input",
    symbol: ["u", "max"],
    dimension: Dimension::INPUT,
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // A limit above the largest input clips nothing.
    range: |scope| {
        let (least, most) = (0.01 * scope.largest_level, 1.01 * scope.largest_level);
        let likely = scope.moving_level.min(0.5 * scope.largest_level);
        Range { bounds: [least, most], likely: [likely, scope.largest_level], absent: Some(most) }
    },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "actuator_saturation",
    title: "actuator saturation",
    with_article: "actuator saturation",
    equation: "u clipped to ±u_max, before A(s)",
    meaning: "the amplifier clips: what is commanded beyond a limit is cut off",
    signature: "nothing below a threshold of the magnitude, above it at every frequency a smaller \
         fundamental and odd harmonics",
    imitators: &["quadratic_drag", "slew_limit"],
    slot: Slot::Saturation,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| vec![scales.lowest * draws.log_uniform(1.3, 3.6)],
        scaled: |scales, values, factor| {
            Some(vec![lowered(values[0], factor, scales.highest, 0.5 * scales.lowest)?])
        },
        by_character: None,
    },
};

impl Effect for ActuatorSaturation {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        let limit = parameters[0];
        axis.add_input_map(InputMap {
            stage: Stage::Saturation,
            breaks: vec![-limit, limit],
            slopes: [0.0, 1.0, 0.0].map(Wide::constant).to_vec(),
        });
    }
}
