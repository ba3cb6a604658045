//! A command that arrives late.
//!
//! u(t − T). A periodic response comes later by T as a whole: Yₖ·exp(−jkωT).

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// T.
#[derive(Debug)]
pub struct TransportDelay;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "delay",
    dimension: Dimension::TIME,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // Beyond half a period of the highest frequency it is ambiguous there.
    range: |scope| {
        let turn = 1.0 / scope.omega_high;
        Range { bounds: [0.0, 6.0 * turn], likely: [0.0, turn], absent: Some(0.0) }
    },
}];

impl Effect for TransportDelay {
    fn id(&self) -> &'static str {
        "transport_delay"
    }

    fn meaning(&self) -> &'static str {
        "the command arrives late by a fixed time, as behind a field bus or a sampled \
         controller"
    }

    fn signature(&self) -> &'static str {
        "a phase lag in proportion to frequency and harmonic, the same at every magnitude, and no \
         change of gain"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["sensor_lag"]
    }

    fn slot(&self) -> Slot {
        Slot::Delay
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.delay += parameters[0];
    }
}
