//! Hardening spring: a spring to the frame that stiffens with the travel (Duffing 1918).
//!
//! g += k·θ + k₃·θ³, where θ is absolute, zero at the spring's rest.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, MachineScales, up_to};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;
use super::spring::STIFFNESS;
use super::taylor_series;
use super::taylor_series::TaylorSeries;

/// Parameters: k and k₃.
#[derive(Debug)]
pub struct HardeningSpring;

const PARAMETERS: [Parameter; 2] = [STIFFNESS, CUBIC_STIFFNESS];

const CUBIC_STIFFNESS: Parameter = Parameter {
    name: "cubic_stiffness",
    title: "cubic stiffness",
    symbol: ["k", "3"],
    dimension: Dimension { input: 1, velocity: -3, time: -3 },
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // `most`: at the largest travel, the cubic torque equals the largest input.
    range: |scope| {
        let most = scope.largest_level / scope.largest_travel.powi(3);
        Range { bounds: [0.0, 100.0 * most], likely: [0.0, most], absent: Some(0.0) }
    },
};

/// The torque k·θ + k₃·θ³.
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

    fn extend(&self, [k, k3, _]: &[f64; LAW_PARAMETERS], m: usize, series: &mut TaylorSeries) {
        let position = series.argument[m];
        let [square, ..] = &mut series.kept;
        square[m] = taylor_series::product(&series.argument, &series.argument, m);
        let cube = taylor_series::product(square, &series.argument, m);
        let linear = if m == 0 { *k } else { 0.0 };
        series.value[m] = k * position + k3 * cube;
        series.by_argument[m] = linear + 3.0 * k3 * square[m];
        series.by_parameter[0][m] = position;
        series.by_parameter[1][m] = cube;
    }

    fn contracts(&self) -> bool {
        false
    }
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "hardening_spring",
    title: "hardening spring",
    with_article: "a hardening spring",
    equation: "g += k·θ + k₃·θ³",
    meaning: "a restoring torque grows faster than the position, as of a bellows or near an end \
         stop",
    signature: "as a spring in the lowest band, and the stiffer the larger the travel: the resonance \
         rises with the magnitude",
    imitators: &["spring", "presliding"],
    slot: Slot::Torque,
    parameters: &PARAMETERS,
    search: SearchPlan { forces_zero_mean: true, ..SearchPlan::DEFAULT },
    draw: DrawPlan {
        draw: |scales, draws| {
            let MachineScales { viscous_rate: a, constant, .. } = scales;
            let stiffness = 0.5 * a * a / constant * draws.log_uniform(0.02, 0.3);
            let per_cube = scales.lowest / scales.travel().powi(3);
            vec![stiffness, per_cube * draws.log_uniform(0.0001, 0.3)]
        },
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, scales.stiffness())?, factor * values[1]])
        },
        by_character: None,
    },
};

impl Effect for HardeningSpring {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Hardening, parameters));
    }
}
