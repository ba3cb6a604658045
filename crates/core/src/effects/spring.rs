//! Spring: a restoring torque between the axis and the machine's frame.
//!
//! g += k·θ, where θ is absolute, zero at the spring's rest.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: k.
#[derive(Debug)]
pub struct Spring;

const PARAMETERS: [Parameter; 1] = [STIFFNESS];

/// k, the stiffness of the spring.
pub(super) const STIFFNESS: Parameter = Parameter {
    name: "stiffness",
    title: "spring stiffness",
    symbol: ["k", ""],
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // k such that the resonance √(K·k) is at `omega`.
    range: |scope| {
        let at = |omega: f64| omega * omega / scope.plant.constant.abs();
        Range {
            bounds: [0.0, at(5.0 * scope.omega_high)],
            likely: [0.0, at(3.0 * scope.omega_low)],
            absent: Some(0.0),
        }
    },
};

/// The torque k·θ.
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

const DESCRIPTOR: Descriptor = Descriptor {
    id: "spring",
    title: "spring",
    with_article: "a spring",
    equation: "g += k·θ",
    meaning: "a restoring torque is in proportion to the position, as of a cable, a hose or \
         gravity",
    signature: "in the lowest band the response is smaller and leads; the mean vanishes at every \
         magnitude",
    imitators: &["hardening_spring", "presliding"],
    slot: Slot::Torque,
    parameters: &PARAMETERS,
    search: SearchPlan { forces_zero_mean: true, ..SearchPlan::DEFAULT },
    draw: DrawPlan {
        draw: |scales, draws| vec![scales.stiffness() * draws.log_uniform(0.02, 0.3)],
        scaled: |scales, values, factor| Some(vec![up_to(values[0], factor, scales.stiffness())?]),
        by_character: None,
    },
};

impl Effect for Spring {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Linear, parameters));
    }
}
