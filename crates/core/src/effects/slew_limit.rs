//! Slew limit: the rate of change of the amplifier's output is limited.
//!
//! A rate limiter before A(s), with output w: w' = ±rate until w meets u again, w = u while
//! |u'| ≤ rate, in the limiter's own periodic steady state. If w never follows u (w ≠ u except at
//! single instants), it is a triangle that turns where it meets u, of amplitude rate·T/4 and zero
//! mean at any magnitude, where T is the period.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, lowered};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: the rate.
#[derive(Debug)]
pub struct SlewLimit;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "rate",
    title: "limit of the rate of the input",
    symbol: ["R", ""],
    dimension: Dimension::INPUT.per(Dimension::TIME),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    range: |scope| {
        // A higher limit changes nothing.
        let steepest = scope.steepest_input;
        Range {
            bounds: [1e-3 * steepest, 1.01 * steepest],
            likely: [0.05 * steepest, steepest],
            absent: Some(1.01 * steepest),
        }
    },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "slew_limit",
    title: "slew limit",
    with_article: "a slew limit",
    equation: "w' = ±R until w meets u again, w = u while |u'| ≤ R, before A(s)",
    meaning: "the amplifier cannot follow fast commands: its output changes at a limited rate",
    signature: "nothing below a threshold of magnitude times frequency, above it a falling gain, a phase \
         lag and odd harmonics",
    imitators: &["actuator_saturation", "sensor_lag"],
    slot: Slot::RateLimit,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| {
            vec![scales.lowest * scales.viscous_rate * draws.log_uniform(1.0, 10.0)]
        },
        scaled: |scales, values, factor| {
            let steepest = scales.highest * scales.fastest_rad_s;
            let least = 0.1 * scales.lowest * scales.viscous_rate;
            Some(vec![lowered(values[0], factor, steepest, least)?])
        },
        by_character: None,
    },
};

impl Effect for SlewLimit {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.rate_limit = Some(parameters[0]);
    }
}
