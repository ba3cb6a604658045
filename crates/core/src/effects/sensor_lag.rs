//! Sensor lag: the sensor, or a filter behind it, is a first-order lag.
//!
//! T·y' + y = v, so that Yₖ = Vₖ/(1 + jkωT).

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: the time constant T.
#[derive(Debug)]
pub struct SensorLag;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "time_constant",
    title: "time constant of the sensor",
    symbol: ["T", ""],
    dimension: Dimension::TIME,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    range: |scope| Range {
        bounds: [0.0, 30.0 / scope.omega_low],
        likely: [0.0, 1.0 / scope.omega_high],
        absent: Some(0.0),
    },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "sensor_lag",
    title: "sensor lag",
    with_article: "a sensor lag",
    equation: "T·y' + y = v",
    meaning: "the sensor, or a filter behind it, follows the motion with a first-order lag",
    signature: "a phase lag that grows with frequency and harmonic and a loss of gain along with it, the \
         same at every magnitude",
    imitators: &["transport_delay"],
    slot: Slot::SensorLag,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| vec![draws.log_uniform(0.005, 0.05) / scales.viscous_rate],
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 1.0 / scales.viscous_rate)?])
        },
        by_character: None,
    },
};

impl Effect for SensorLag {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.sensor_lags.push(parameters[0]);
    }
}
