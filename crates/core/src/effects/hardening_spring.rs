//! A spring to the frame that stiffens (Duffing 1918).
//!
//! g += k·θ + k₃·θ³, θ absolute, zero at the spring's rest.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;
use super::spring::STIFFNESS;
use super::taylor_series;
use super::taylor_series::TaylorSeries;

/// k and k₃.
#[derive(Debug)]
pub struct HardeningSpring;

const PARAMETERS: [Parameter; 2] = [STIFFNESS, CUBIC_STIFFNESS];

const CUBIC_STIFFNESS: Parameter = Parameter {
    name: "cubic_stiffness",
    dimension: Dimension { input: 1, velocity: -3, time: -3 },
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // As much torque at the largest travel as there is.
    range: |scope| {
        let most = scope.largest_level / scope.largest_travel.powi(3);
        Range { bounds: [0.0, 100.0 * most], likely: [0.0, most], absent: Some(0.0) }
    },
};

/// k·θ + k₃·θ³.
#[derive(Debug)]
struct Hardening;

impl Form for Hardening {
    fn at(&self, [k, k3, _]: &[f64; LAW_PARAMETERS], _velocity: f64, position: f64) -> Partials {
        let square = position * position;
        Partials {
            value: (k + k3 * square) * position,
            by_velocity: 0.0,
            by_position: k + 3.0 * k3 * square,
            by_parameter: [position, square * position, 0.0],
        }
    }

    fn uses_position(&self) -> bool {
        true
    }

    fn has_series(&self) -> bool {
        true
    }

    fn extend(&self, [k, k3, _]: &[f64; LAW_PARAMETERS], m: usize, jet: &mut TaylorSeries) {
        let position = jet.argument[m];
        let [square, ..] = &mut jet.kept;
        square[m] = taylor_series::product(&jet.argument, &jet.argument, m);
        let cube = taylor_series::product(square, &jet.argument, m);
        let linear = if m == 0 { *k } else { 0.0 };
        jet.value[m] = k * position + k3 * cube;
        jet.by_argument[m] = linear + 3.0 * k3 * square[m];
        jet.by_parameter[0][m] = position;
        jet.by_parameter[1][m] = cube;
    }

    fn contracts(&self) -> bool {
        false
    }
}

impl Effect for HardeningSpring {
    fn id(&self) -> &'static str {
        "hardening_spring"
    }

    fn meaning(&self) -> &'static str {
        "a restoring torque grows faster than the position, as of a bellows or near an end \
         stop"
    }

    fn signature(&self) -> &'static str {
        "as a spring in the lowest band, and the stiffer the larger the travel: the resonance \
         rises with the magnitude"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["spring", "presliding"]
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
        axis.torques.push(Law::new(&Hardening, parameters));
    }
}
