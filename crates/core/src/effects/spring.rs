//! A spring to the machine's frame.
//!
//! g += k·θ, θ absolute, zero at the spring's rest.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// k.
#[derive(Debug)]
pub struct Spring;

const PARAMETERS: [Parameter; 1] = [STIFFNESS];

/// k.
pub(super) const STIFFNESS: Parameter = Parameter {
    name: "stiffness",
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // A resonance √(K·k) up to a few times the highest frequency.
    range: |scope| {
        let at = |omega: f64| omega * omega / scope.plant.constant.abs();
        Range {
            bounds: [0.0, at(5.0 * scope.omega_high)],
            likely: [0.0, at(3.0 * scope.omega_low)],
            absent: Some(0.0),
        }
    },
};

/// k·θ.
#[derive(Debug)]
struct Linear;

impl Form for Linear {
    fn at(&self, [k, ..]: &[f64; LAW_PARAMETERS], _velocity: f64, position: f64) -> Partials {
        Partials {
            value: k * position,
            by_velocity: 0.0,
            by_position: *k,
            by_parameter: [position, 0.0, 0.0],
        }
    }

    fn uses_position(&self) -> bool {
        true
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn contracts(&self) -> bool {
        true
    }
}

impl Effect for Spring {
    fn id(&self) -> &'static str {
        "spring"
    }

    fn meaning(&self) -> &'static str {
        "a restoring torque is in proportion to the position, as of a cable, a hose or \
         gravity"
    }

    fn signature(&self) -> &'static str {
        "in the lowest band the response is smaller and leads; the mean vanishes at every \
         magnitude"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["hardening_spring", "presliding"]
    }

    fn slot(&self) -> Slot {
        Slot::Torque
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn settles(&self) -> bool {
        true
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Linear, parameters));
    }
}
