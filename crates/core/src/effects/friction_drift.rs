//! Friction drift: friction changes during the acquisition, for example as a bearing warms up.
//!
//! All friction levels, Fc and Fs, are multiplied by 1 + δ·(run − run_min)/(run_max − run_min),
//! where `run` is the position in the order of acquisition. Not testable without `run`.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: δ.
#[derive(Debug)]
pub struct FrictionDrift;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "delta",
    title: "drift of friction over the runs",
    symbol: ["δ", ""],
    dimension: Dimension::NONE,
    domain: Domain::AboveMinusOne,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.99, 4.0], likely: [-0.5, 0.5], absent: Some(0.0) },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "friction_drift",
    title: "friction drift",
    with_article: "friction drift",
    equation: "Fc and Fs × (1 + δ·(run − run_min)/(run_max − run_min))",
    meaning: "friction changed while the measurement was taken, as when a machine warms up",
    signature: "residuals follow the order of acquisition, not magnitude or frequency, with the shape \
         that a change of friction has",
    imitators: &["stribeck", "quadratic_drag"],
    slot: Slot::FrictionScale,
    parameters: &PARAMETERS,
    search: SearchPlan { needs_run: true, ..SearchPlan::DEFAULT },
    draw: DrawPlan {
        draw: |_, draws| vec![draws.signed(0.1, 0.4)],
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 0.9)?]),
        by_character: None,
    },
};

impl Effect for FrictionDrift {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], run_share: f64, axis: &mut Axis<Wide>) {
        axis.friction_scale = axis.friction_scale * (parameters[0] * run_share + 1.0);
    }
}
