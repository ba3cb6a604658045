//! Presliding: the contact deforms elastically before it slides (Dahl 1968).
//!
//! z' = v − |v|·σ·z/Fc(sgn v) and f = σ·z replace set-valued friction, where z is the deflection of
//! the bristles and σ their stiffness. The axis never rests: below breakaway it moves on its
//! bristles. Together with a friction curve, Fc is multiplied by the curve at v.

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::DrawPlan;
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Parameter: σ.
#[derive(Debug)]
pub struct Presliding;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "sigma",
    title: "bristle stiffness",
    symbol: ["σ", ""],
    dimension: Dimension::INPUT.per(Dimension::POSITION),
    domain: Domain::Positive,
    coordinate: Coordinate::Logarithmic,
    // The largest deflection is Fc/σ. At the softest likely σ it equals the largest travel. At the
    // stiffest it is so short that no data can tell the bristle from set-valued friction.
    range: |scope| {
        let softest = scope.friction_level() / scope.largest_travel;
        Range {
            bounds: [0.1 * softest, 1e8 * softest],
            likely: [softest, 1e6 * softest],
            absent: Some(f64::INFINITY),
        }
    },
}];

/// Largest σ that the benchmark draws, in F/X (see `MachineScales`): the time to integrate a period
/// grows with σ.
const STIFFEST_DRAWN: f64 = 1e3;

/// The effect is proportional to 1/√σ: presliding after a reversal lasts √(2·Fc/(σ·v')).
fn resize(values: &mut [f64], _ranges: &[Range], factor: f64) {
    values[0] /= factor * factor;
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "presliding",
    title: "presliding",
    with_article: "presliding",
    equation: "z' = v − |v|·σ·z/Fc(sgn v), f = σ·z, in place of set-valued friction",
    meaning: "before it slides the contact yields like a spring: the axis moves below breakaway",
    signature: "the axis moves where it should rest, with a phase lead; strongest at the lowest \
         magnitude and at high frequencies, where the travel is short",
    imitators: &["static_friction", "stribeck", "spring"],
    slot: Slot::Bristle,
    parameters: &PARAMETERS,
    search: SearchPlan { resize, ..SearchPlan::DEFAULT },
    draw: DrawPlan {
        draw: |scales, draws| vec![scales.level() / scales.travel() * draws.log_uniform(3.0, 60.0)],
        scaled: |scales, values, factor| {
            let softest = scales.level() / scales.travel();
            let sigma = (values[0] / factor).min(STIFFEST_DRAWN * softest);
            (sigma >= softest).then(|| vec![sigma])
        },
        by_character: None,
    },
};

impl Effect for Presliding {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.bristle = Some(parameters[0]);
    }
}
