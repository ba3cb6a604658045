//! Cogging: a torque that is sinusoidal in position.
//!
//! g += T·sin(N·θ + φ), together with the constant torque that makes the mean of v zero; θ has zero
//! mean. T is the amplitude, N the spatial frequency in radians per position unit, φ the phase.

use std::f64::consts::{PI, TAU};

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::law::{Form, LAW_PARAMETERS, Law, Partials};
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::{SearchPlan, Starts};
use super::slot::Slot;
use super::taylor_series;
use super::taylor_series::TaylorSeries;

/// Parameters: T, N and φ.
#[derive(Debug)]
pub struct Cogging;

const PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "amplitude",
        title: "amplitude of the cogging",
        symbol: ["T", ""],
        dimension: Dimension::INPUT,
        domain: Domain::NotNegative,
        coordinate: Coordinate::Linear,
        range: |scope| Range {
            bounds: [0.0, 2.0 * scope.largest_level],
            likely: [0.0, scope.friction_level()],
            absent: Some(0.0),
        },
    },
    Parameter {
        name: "cycles_per_unit",
        title: "angular spatial frequency of the cogging",
        symbol: ["N", ""],
        dimension: Dimension::NONE.per(Dimension::POSITION),
        domain: Domain::Positive,
        coordinate: Coordinate::Logarithmic,
        // `angle`: N times the largest travel, rad. Below 1 the torque acts like a spring; at the
        // upper end it averages out over the travel.
        range: |scope| Range {
            bounds: [1.0, 1000.0].map(|angle| angle / scope.largest_travel),
            likely: [3.0, 300.0].map(|angle| angle / scope.largest_travel),
            absent: None,
        },
    },
    Parameter {
        name: "phase",
        title: "phase of the cogging",
        symbol: ["φ", ""],
        dimension: Dimension::NONE,
        domain: Domain::Any,
        coordinate: Coordinate::Angle,
        // More than a turn on either side, so that no solution lies on a bound.
        range: |_| Range { bounds: [-7.0, 7.0], likely: [-PI, PI], absent: None },
    },
];

/// The torque T·sin(N·θ + φ).
#[derive(Debug)]
struct Ripple;

impl Form for Ripple {
    fn at(&self, [t, n, phase]: &[f64; LAW_PARAMETERS], _v: f64, position: f64) -> Partials {
        let (sin, cos) = (n * position + phase).sin_cos();
        Partials {
            value: t * sin,
            by_velocity: 0.0,
            by_position: t * n * cos,
            by_parameter: [sin, t * cos * position, t * cos],
        }
    }

    fn uses_position(&self) -> bool {
        true
    }

    fn has_series(&self) -> bool {
        true
    }

    fn ripples(&self) -> bool {
        true
    }

    fn extend(&self, [t, n, phase]: &[f64; LAW_PARAMETERS], m: usize, series: &mut TaylorSeries) {
        let [sin, cos, rates] = &mut series.kept;
        rates[m] = m as f64 * n * series.argument[m];
        (sin[m], cos[m]) = match m {
            0 => (n * series.argument[0] + phase).sin_cos(),
            _ => taylor_series::sin_cos(rates, sin, cos, m),
        };
        series.value[m] = t * sin[m];
        series.by_argument[m] = t * n * cos[m];
        if series.parameters_vary {
            let by_cycles = t * taylor_series::product(cos, &series.argument, m);
            let all = [sin[m], by_cycles, t * cos[m]];
            series.by_parameter.iter_mut().zip(all).for_each(|(terms, term)| terms[m] = term);
        }
    }

    fn contracts(&self) -> bool {
        false
    }
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "cogging",
    title: "cogging",
    with_article: "cogging",
    equation: "g += T·sin(N·θ + φ), with the constant that makes the mean of v zero; θ has zero mean; \
         N is 2π divided by the distance after which the cogging repeats",
    meaning: "a torque ripples with the position: cogging of the motor, teeth of a gear, an \
         eccentric",
    signature: "harmonics, even ones too, that come and go as the travel covers one tooth more; \
         strongest at low frequencies, where the travel is long",
    imitators: &["spring", "hardening_spring", "stribeck"],
    slot: Slot::Torque,
    parameters: &PARAMETERS,
    search: SearchPlan {
        starts: Starts::FrequencyScan,
        forces_zero_mean: true,
        ..SearchPlan::DEFAULT
    },
    draw: DrawPlan {
        draw: |scales, draws| {
            let amplitude = scales.level() * draws.log_uniform(0.1, 0.6);
            let cycles_per_unit = draws.log_uniform(1.0, 10.0) / scales.travel();
            vec![amplitude, cycles_per_unit, TAU * draws.log_uniform(0.01, 1.0)]
        },
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 2.0 * scales.level())?, values[1], values[2]])
        },
        by_character: None,
    },
};

impl Effect for Cogging {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Ripple, parameters));
        axis.balanced = true;
    }
}
