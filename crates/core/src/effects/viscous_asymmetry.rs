//! Viscous asymmetry: viscous friction depends on the direction of motion.
//!
//! The viscous rate a becomes a(1 + α) for v > 0 and a(1 − α) for v < 0.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: α.
#[derive(Debug)]
pub struct ViscousAsymmetry;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "alpha",
    title: "asymmetry of viscous friction",
    symbol: ["α", ""],
    dimension: Dimension::NONE,
    domain: Domain::BelowOneInSize,
    coordinate: Coordinate::Linear,
    range: |_| Range { bounds: [-0.95, 0.95], likely: [-0.4, 0.4], absent: Some(0.0) },
}];

const DESCRIPTOR: Descriptor = Descriptor {
    id: "viscous_asymmetry",
    title: "viscous asymmetry",
    with_article: "viscous asymmetry",
    equation: "a becomes a·(1 + α) for v > 0 and a·(1 − α) for v < 0",
    meaning: "the damping depends on the direction of motion, as with a one-sided seal or gear",
    signature: "a mean velocity and even harmonics that grow in proportion to the magnitude, strongest \
         below the pole",
    imitators: &["gain_asymmetry"],
    slot: Slot::ViscousRate,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |_, draws| vec![draws.signed(0.05, 0.3)],
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 0.9)?]),
        by_character: None,
    },
};

impl Effect for ViscousAsymmetry {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.viscous_asymmetry = parameters[0];
    }
}
