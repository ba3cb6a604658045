//! Transport delay: the command arrives late by a fixed time T.
//!
//! u(t − T) in place of u(t). It delays a periodic response as a whole: Yₖ·exp(−jkωT).

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: T.
#[derive(Debug)]
pub struct TransportDelay;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "delay",
    title: "delay of the input",
    symbol: ["T", ""],
    dimension: Dimension::TIME,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // The upper bound is 6 rad of phase at the highest frequency, where a full turn is ambiguous.
    range: |scope| {
        let one_radian = 1.0 / scope.omega_high;
        Range { bounds: [0.0, 6.0 * one_radian], likely: [0.0, one_radian], absent: Some(0.0) }
    },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "transport_delay",
    title: "transport delay",
    with_article: "a transport delay",
    equation: "u(t − T)",
    meaning: "the command arrives late by a fixed time, as behind a field bus or a sampled \
         controller",
    signature: "a phase lag in proportion to frequency and harmonic, the same at every magnitude, and no \
         change of gain",
    imitators: &["sensor_lag"],
    slot: Slot::Delay,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| vec![draws.log_uniform(0.005, 0.05) / scales.viscous_rate],
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 1.0 / scales.viscous_rate)?])
        },
        by_character: None,
    },
};

impl Effect for TransportDelay {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.delay += parameters[0];
    }
}
