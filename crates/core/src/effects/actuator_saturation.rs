//! An amplifier at its limit.
//!
//! u clipped to ±limit, before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;
use crate::plant::Scalar as _;

/// The limit.
#[derive(Debug)]
pub struct ActuatorSaturation;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "limit",
    dimension: Dimension::INPUT,
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // Above the largest input there is nothing to clip.
    range: |scope| {
        let (least, most) = (0.01 * scope.largest_level, 1.01 * scope.largest_level);
        let likely = scope.moving_level.min(0.5 * scope.largest_level);
        Range { bounds: [least, most], likely: [likely, scope.largest_level], absent: Some(most) }
    },
}];

impl Effect for ActuatorSaturation {
    fn id(&self) -> &'static str {
        "actuator_saturation"
    }

    fn meaning(&self) -> &'static str {
        "the amplifier clips: what is commanded beyond a limit is cut off"
    }

    fn signature(&self) -> &'static str {
        "nothing below a threshold of the magnitude, above it at every frequency a smaller \
         fundamental and odd harmonics"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["quadratic_drag", "slew_limit"]
    }

    fn slot(&self) -> Slot {
        Slot::Saturation
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
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
