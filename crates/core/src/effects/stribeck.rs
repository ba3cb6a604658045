//! Friction that falls as the axis gains speed (Stribeck 1902).
//!
//! f(v) = sgn(v)·Fc·[1 + (r − 1)·exp(−(v/vs)²)], breakaway r·Fc.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// r and vs.
#[derive(Debug)]
pub struct Stribeck;

const PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "fs_over_fc",
        dimension: Dimension::NONE,
        domain: Domain::AtLeastOne,
        coordinate: Coordinate::Linear,
        range: |_| Range { bounds: [0.2, 20.0], likely: [1.05, 2.5], absent: Some(1.0) },
    },
    Parameter {
        name: "stribeck_velocity",
        dimension: Dimension::VELOCITY,
        domain: Domain::Positive,
        coordinate: Coordinate::Logarithmic,
        // Slower than a ten-thousandth of the fastest motion it is static friction,
        // much faster than it a change of the Coulomb level.
        range: |scope| Range {
            bounds: [1e-4, 3.0].map(|share| share * scope.largest_velocity),
            likely: [0.01, 0.5].map(|share| share * scope.largest_velocity),
            absent: None,
        },
    },
];

/// 1 + (r − 1)·exp(−(v/vs)²).
#[derive(Debug)]
struct Curve;

impl Form for Curve {
    fn at(&self, [r, vs, _]: &[f64; LAW_PARAMETERS], velocity: f64, _position: f64) -> Partials {
        let share = velocity / vs;
        let bump = (-share * share).exp();
        let slope = (r - 1.0) * bump * 2.0 * share / vs;
        Partials {
            value: 1.0 + (r - 1.0) * bump,
            by_velocity: -slope,
            by_position: 0.0,
            by_parameter: [bump, slope * share, 0.0],
        }
    }

    fn velocity_scale(&self, [_, vs, _]: &[f64; LAW_PARAMETERS]) -> Option<f64> {
        Some(*vs)
    }

    fn uses_position(&self) -> bool {
        false
    }

    fn contracts(&self) -> bool {
        false
    }
}

impl Effect for Stribeck {
    fn id(&self) -> &'static str {
        "stribeck"
    }

    fn meaning(&self) -> &'static str {
        "friction falls as the axis gains speed, as in a bearing, guide or seal with mixed \
         lubrication"
    }

    fn signature(&self) -> &'static str {
        "strongest at the lowest magnitude and lowest frequencies, in the odd harmonics; fades as \
         the magnitude grows"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["static_friction", "quadratic_drag", "presliding"]
    }

    fn slot(&self) -> Slot {
        Slot::FrictionCurve
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    // So narrow a curve is static friction that is alike both ways, to most data.
    fn rarer_where_small(&self) -> Option<usize> {
        Some(1)
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.friction_curve = Some(Law::new(&Curve, parameters));
    }
}
