//! Quadratic drag: a resisting torque that grows with the square of the velocity.
//!
//! g += c·v·|v|.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;
use super::taylor_series;
use super::taylor_series::TaylorSeries;

/// Parameter: c.
#[derive(Debug)]
pub struct QuadraticDrag;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "c",
    title: "drag coefficient",
    symbol: ["c", ""],
    dimension: Dimension::INPUT.per(Dimension::VELOCITY).per(Dimension::VELOCITY),
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // `most`: at the largest velocity, the drag equals the largest input.
    range: |scope| {
        let most = scope.largest_level / (scope.largest_velocity * scope.largest_velocity);
        Range { bounds: [0.0, 20.0 * most], likely: [0.0, most], absent: Some(0.0) }
    },
}];

/// The torque c·v·|v|.
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

    fn extend(&self, [c, ..]: &[f64; LAW_PARAMETERS], m: usize, series: &mut TaylorSeries) {
        let direction = series.direction;
        let square = direction * taylor_series::product(&series.argument, &series.argument, m);
        series.value[m] = c * square;
        series.by_argument[m] = 2.0 * c * direction * series.argument[m];
        series.by_parameter[0][m] = square;
    }

    fn contracts(&self) -> bool {
        true
    }
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "quadratic_drag",
    title: "quadratic drag",
    with_article: "quadratic drag",
    equation: "g += c·v·|v|",
    meaning: "a drag grows with the square of the speed, as of a fan or churned lubricant",
    signature: "the gain falls as the magnitude grows, most below the pole, with a third harmonic that \
         grows faster than the magnitude",
    imitators: &["stribeck", "actuator_saturation"],
    slot: Slot::Torque,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| {
            let velocity = scales.velocity();
            vec![scales.lowest / (velocity * velocity) * draws.log_uniform(0.02, 0.3)]
        },
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 3.0 * scales.lowest / scales.velocity().powi(2))?])
        },
        by_character: None,
    },
};

impl Effect for QuadraticDrag {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Drag, parameters));
    }
}
