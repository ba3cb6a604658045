//! Static friction: a level above the Coulomb level that acts at v = 0 only.
//!
//! At v = 0, f takes whatever value in [−Fs⁻, +Fs⁺] keeps the axis at rest, with Fs > Fc. Between
//! switches of the friction the equations of motion stay linear.

use crate::plant::{Friction, Scalar as _};

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::draw_plan::{DrawPlan, up_to};
use super::effect::Effect;
use super::parameter::{Coordinate, Dimension, Domain, Parameter, Range, Scope};
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// Least relative excess Fs/Fc − 1 that [`escape_dead_zone`] assumes: enough for a level to act,
/// too little to change the response noticeably.
const LEAST_EXCESS: f64 = 1e-6;

/// Parameters: Fs⁺ and Fs⁻; a value below the Coulomb level counts as the Coulomb level.
#[derive(Debug)]
pub struct StaticFriction;

const PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "fs_plus",
        title: "static friction forwards",
        symbol: ["F", "s+"],
        dimension: Dimension::INPUT,
        domain: Domain::NotNegative,
        coordinate: Coordinate::Linear,
        range: |scope| range(scope, scope.plant.friction.fc_plus),
    },
    Parameter {
        name: "fs_minus",
        title: "static friction backwards",
        symbol: ["F", "s−"],
        dimension: Dimension::INPUT,
        domain: Domain::NotNegative,
        coordinate: Coordinate::Linear,
        range: |scope| range(scope, scope.plant.friction.fc_minus),
    },
];

fn range(scope: &Scope, coulomb: f64) -> Range {
    let likely = [coulomb, (2.0 * coulomb).max(scope.moving_level)];
    Range { bounds: [0.0, 1.05 * scope.largest_level], likely, absent: Some(coulomb) }
}

/// If a static level lies below its Coulomb level, sets both above theirs by the same share, half
/// of the larger excess. A level below the Coulomb level has no influence, and what one level alone
/// explains, both together may explain better.
fn escape_dead_zone(values: &mut [f64], friction: &Friction) {
    let coulomb = [friction.fc_plus, friction.fc_minus];
    if values.iter().zip(coulomb).all(|(level, coulomb)| *level >= coulomb) {
        return;
    }
    let excess = values.iter().zip(coulomb).map(|(level, coulomb)| level / coulomb - 1.0);
    let share = 0.5 * excess.filter(|excess| excess.is_finite()).fold(LEAST_EXCESS, f64::max);
    values.iter_mut().zip(coulomb).for_each(|(level, coulomb)| *level = (1.0 + share) * coulomb);
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "static_friction",
    title: "static friction",
    with_article: "static friction",
    equation: "v = 0: −Fs⁻ ≤ f ≤ Fs⁺, with Fs > Fc",
    meaning: "breakaway takes more torque than sliding: at every reversal the axis sticks until \
         the static level is exceeded",
    signature: "at the lowest magnitudes and frequencies the axis rests longer at every reversal and \
         starts with a jump of acceleration; nothing changes where it slides through",
    imitators: &["stribeck", "presliding"],
    slot: Slot::StaticLevel,
    parameters: &PARAMETERS,
    search: SearchPlan { escape_dead_zone: Some(escape_dead_zone), ..SearchPlan::DEFAULT },
    draw: DrawPlan {
        draw: |scales, draws| scales.coulomb.map(|fc| fc * draws.log_uniform(1.1, 1.9)).to_vec(),
        scaled: |scales, values, factor| {
            let level =
                |(fs, fc): (&f64, f64)| Some(fc * (1.0 + up_to(fs / fc - 1.0, factor, 2.0)?));
            values.iter().zip(scales.coulomb).map(level).collect()
        },
        by_character: None,
    },
};

impl Effect for StaticFriction {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        let friction = &mut axis.plant.friction;
        let larger = |a: Wide, b: Wide| if a.value() >= b.value() { a } else { b };
        friction.fs_plus = larger(parameters[0], friction.fc_plus);
        friction.fs_minus = larger(parameters[1], friction.fc_minus);
    }
}
