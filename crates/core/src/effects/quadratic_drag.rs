//! Drag that grows with the square of the velocity.
//!
//! g += c·v·|v|.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;
use super::taylor_series;
use super::taylor_series::TaylorSeries;

/// c.
#[derive(Debug)]
pub struct QuadraticDrag;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "c",
    dimension: Dimension::INPUT.per(Dimension::VELOCITY).per(Dimension::VELOCITY),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // As much torque at the largest velocity as there is.
    range: |scope| {
        let most = scope.largest_level / (scope.largest_velocity * scope.largest_velocity);
        Range { bounds: [0.0, 20.0 * most], likely: [0.0, most], absent: Some(0.0) }
    },
}];

/// c·v·|v|.
#[derive(Debug)]
struct Drag;

impl Form for Drag {
    fn at(&self, [c, ..]: &[f64; LAW_PARAMETERS], velocity: f64, _position: f64) -> Partials {
        let size = velocity.abs();
        Partials {
            value: c * velocity * size,
            by_velocity: 2.0 * c * size,
            by_position: 0.0,
            by_parameter: [velocity * size, 0.0, 0.0],
        }
    }

    fn uses_position(&self) -> bool {
        false
    }

    fn has_series(&self) -> bool {
        true
    }

    fn extend(&self, [c, ..]: &[f64; LAW_PARAMETERS], m: usize, jet: &mut TaylorSeries) {
        let direction = jet.direction;
        let square = direction * taylor_series::product(&jet.argument, &jet.argument, m);
        jet.value[m] = c * square;
        jet.by_argument[m] = 2.0 * c * direction * jet.argument[m];
        jet.by_parameter[0][m] = square;
    }

    fn contracts(&self) -> bool {
        true
    }
}

impl Effect for QuadraticDrag {
    fn id(&self) -> &'static str {
        "quadratic_drag"
    }

    fn meaning(&self) -> &'static str {
        "a drag grows with the square of the speed, as of a fan or churned lubricant"
    }

    fn signature(&self) -> &'static str {
        "the gain falls as the magnitude grows, most below the pole, with a third harmonic that \
         grows faster than the magnitude"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["stribeck", "actuator_saturation"]
    }

    fn slot(&self) -> Slot {
        Slot::Torque
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Drag, parameters));
    }
}
