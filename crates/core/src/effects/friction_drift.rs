//! Friction that drifts during the acquisition, as a bearing warms up.
//!
//! All friction levels, Fc and Fs, × (1 + δ·(run − run_min)/(run_max − run_min)).
//! Not testable without `run`.

use super::axis::{Axis, Wide};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::slot::Slot;

/// δ.
#[derive(Debug)]
pub struct FrictionDrift;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "delta",
    dimension: Dimension::NONE,
    domain: Domain::AboveMinusOne,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.99, 4.0], likely: [-0.5, 0.5], absent: Some(0.0) },
}];

impl Effect for FrictionDrift {
    fn id(&self) -> &'static str {
        "friction_drift"
    }

    fn meaning(&self) -> &'static str {
        "friction changed while the measurement was taken, as when a machine warms up"
    }

    fn signature(&self) -> &'static str {
        "residuals follow the order of acquisition, not magnitude or frequency, with the shape \
         that a change of friction has"
    }

    fn imitators(&self) -> &'static [&'static str] {
        &["stribeck", "quadratic_drag"]
    }

    fn slot(&self) -> Slot {
        Slot::FrictionScale
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn needs_run(&self) -> bool {
        true
    }

    fn enter(&self, parameters: &[Wide], run_share: f64, axis: &mut Axis<Wide>) {
        axis.friction_scale = axis.friction_scale * (parameters[0] * run_share + 1.0);
    }
}
