//! Elastic friction before the axis slides (Dahl 1968).
//!
//! z' = v − |v|·σ·z/Fc(sgn v), f = σ·z, in place of set-valued friction. There
//! is no rest: below breakaway the axis moves on its bristles. Together with a
//! friction curve, Fc is what the curve makes of it.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// σ.
#[derive(Debug)]
pub struct Presliding;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "sigma",
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // From a bristle as long as the longest travel to one that is short beside
    // the shortest, which nothing tells from set-valued friction.
    range: |scope| {
        let softest = scope.friction_level() / scope.largest_travel;
        Range {
            bounds: [0.1 * softest, 1e8 * softest],
            likely: [softest, 1e6 * softest],
            absent: Some(f64::INFINITY),
        }
    },
}];

impl Effect for Presliding {
    fn id(&self) -> &'static str {
        "presliding"
    }

    fn meaning(&self) -> &'static str {
        "before it slides the contact yields like a spring: the axis moves below breakaway"
    }

    fn signature(&self) -> &'static str {
        "the axis moves where it should rest, with a phase lead; strongest at the lowest \
         magnitude and at high frequencies, where the travel is short"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["static_friction", "stribeck", "spring"]
    }

    fn slot(&self) -> Slot {
        Slot::Bristle
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    // The bristle's share of a reversal lasts √(2·Fc/(σ·v')).
    fn resize(&self, values: &mut [f64], _ranges: &[Range], factor: f64) {
        values[0] /= factor * factor;
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.bristle = Some(parameters[0]);
    }
}
