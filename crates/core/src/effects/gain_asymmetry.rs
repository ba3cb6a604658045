//! An amplifier whose halves differ.
//!
//! (1 + γ)u for u > 0, (1 − γ)u for u < 0, before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;
use crate::plant::Scalar as _;

/// γ.
#[derive(Debug)]
pub struct GainAsymmetry;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "gamma",
    dimension: Dimension::NONE,
    domain: Domain::BelowOneInSize,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.95, 0.95], likely: [-0.3, 0.3], absent: Some(0.0) },
}];

impl Effect for GainAsymmetry {
    fn id(&self) -> &'static str {
        "gain_asymmetry"
    }

    fn meaning(&self) -> &'static str {
        "the amplifier is stronger in one direction than in the other"
    }

    fn signature(&self) -> &'static str {
        "a mean and even harmonics in proportion to the magnitude, at every frequency"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["viscous_asymmetry"]
    }

    fn slot(&self) -> Slot {
        Slot::Gain
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        let gamma = parameters[0];
        axis.add_input_map(InputMap {
            stage: Stage::Gain,
            breaks: vec![Wide::constant(0.0)],
            slopes: vec![-gamma + 1.0, gamma + 1.0],
        });
    }
}
