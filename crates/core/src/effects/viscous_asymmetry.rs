//! Viscous friction that differs between directions.
//!
//! a becomes a(1 + α) for v > 0 and a(1 − α) for v < 0.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// α.
#[derive(Debug)]
pub struct ViscousAsymmetry;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "alpha",
    dimension: Dimension::NONE,
    domain: Domain::BelowOneInSize,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.95, 0.95], likely: [-0.4, 0.4], absent: Some(0.0) },
}];

impl Effect for ViscousAsymmetry {
    fn id(&self) -> &'static str {
        "viscous_asymmetry"
    }

    fn meaning(&self) -> &'static str {
        "the damping depends on the direction of motion, as with a one-sided seal or gear"
    }

    fn signature(&self) -> &'static str {
        "a mean velocity and even harmonics that grow in proportion to the magnitude, strongest \
         below the pole"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["gain_asymmetry"]
    }

    fn slot(&self) -> Slot {
        Slot::ViscousRate
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.viscous_asymmetry = parameters[0];
    }
}
