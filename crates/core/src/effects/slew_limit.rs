//! An amplifier that cannot change fast enough.
//!
//! A rate limiter before A(s): w' = ±rate until w meets u again, w = u while
//! |u'| ≤ rate, in its own periodic steady state (never meeting u, it is a
//! triangle of amplitude rate·T/4 and zero mean, whatever m).

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// The rate.
#[derive(Debug)]
pub struct SlewLimit;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "rate",
    dimension: Dimension::INPUT.per(Dimension::TIME),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    range: |scope| {
        let fastest = scope.largest_level * scope.omega_high;
        Range {
            bounds: [1e-3 * fastest, 1.01 * fastest],
            likely: [0.05 * fastest, fastest],
            absent: Some(1.01 * fastest),
        }
    },
}];

impl Effect for SlewLimit {
    fn id(&self) -> &'static str {
        "slew_limit"
    }

    fn meaning(&self) -> &'static str {
        "the amplifier cannot follow fast commands: its output changes at a limited rate"
    }

    fn signature(&self) -> &'static str {
        "nothing below a threshold of magnitude times frequency, above it a falling gain, a phase \
         lag and odd harmonics"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["actuator_saturation", "sensor_lag"]
    }

    fn slot(&self) -> Slot {
        Slot::RateLimit
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.rate_limit = Some(parameters[0]);
    }
}
