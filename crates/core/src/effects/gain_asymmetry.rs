//! Gain asymmetry: the gain of the amplifier depends on the sign of the command.
//!
//! (1 + γ)·u for u > 0 and (1 − γ)·u for u < 0, before A(s).

use super::axis::{Axis, InputMap, Stage, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;
use crate::plant::Scalar as _;

/// Parameter: γ.
#[derive(Debug)]
pub struct GainAsymmetry;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "gamma",
    title: "asymmetry of the gain",
    symbol: ["γ", ""],
    dimension: Dimension::NONE,
    domain: Domain::BelowOneInSize,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.95, 0.95], likely: [-0.3, 0.3], absent: Some(0.0) },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "gain_asymmetry",
    title: "gain asymmetry",
    with_article: "gain asymmetry",
    equation: "(1 + γ)·u for u > 0, (1 − γ)·u for u < 0, before A(s)",
    meaning: "the amplifier is stronger in one direction than in the other",
    signature: "a mean and even harmonics in proportion to the magnitude, at every frequency",
    imitators: &["viscous_asymmetry"],
    slot: Slot::Gain,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |_, draws| vec![draws.signed(0.03, 0.2)],
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 0.8)?]),
        by_character: None,
    },
};

impl Effect for GainAsymmetry {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
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
