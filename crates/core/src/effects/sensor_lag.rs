//! A sensor that follows late.
//!
//! T·y' + y = v: Yₖ = Vₖ/(1 + jkωT).

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// T.
#[derive(Debug)]
pub struct SensorLag;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "time_constant",
    dimension: Dimension::TIME,
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    range: |scope| Range {
        bounds: [0.0, 30.0 / scope.omega_low],
        likely: [0.0, 1.0 / scope.omega_high],
        absent: Some(0.0),
    },
}];

impl Effect for SensorLag {
    fn id(&self) -> &'static str {
        "sensor_lag"
    }

    fn meaning(&self) -> &'static str {
        "the sensor, or a filter behind it, follows the motion with a first-order lag"
    }

    fn signature(&self) -> &'static str {
        "a phase lag that grows with frequency and harmonic and a loss of gain along with it, the \
         same at every magnitude"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["transport_delay"]
    }

    fn slot(&self) -> Slot {
        Slot::SensorLag
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.sensor_lags.push(parameters[0]);
    }
}
