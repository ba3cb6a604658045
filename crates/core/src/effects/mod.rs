//! The library of physical effects that the base model may lack: one file for each effect.
//!
//! The file of an effect holds its [`Descriptor`] (equation, parameters with units and ranges,
//! texts for reports, slot, how a search tries it, how the benchmark draws it) and the code that
//! adds it to the simulated [`Axis`]. A new effect takes such a file, its `mod` line and a line in
//! [`ALL`]; see `docs/adding-an-effect.md`. The contract, section 3, defines every effect.

mod active;
mod axis;
mod descriptor;
mod draw_plan;
mod effect;
mod effort;
mod given;
mod law;
mod library;
mod parameter;
mod search_plan;
mod slot;
mod taylor_series;

mod actuator_dead_zone;
mod actuator_saturation;
mod backlash;
mod cogging;
mod flexible_mode;
mod friction_drift;
mod gain_asymmetry;
mod hardening_spring;
mod presliding;
mod quadratic_drag;
mod sensor_lag;
mod slew_limit;
mod spring;
mod static_friction;
mod stribeck;
mod transport_delay;
mod viscous_asymmetry;

use crate::plant::{Plant, Scalar};

pub use active::{ActiveEffect, WrongParameters};
pub use axis::{Axis, InputMap, SecondMass, Stage, WIDE_LANES, Wide};
pub use descriptor::Descriptor;
pub use draw_plan::{DrawPlan, Draws, MachineScales, Middle, Scaling, lowered, up_to};
pub use effect::Effect;
pub use effort::{Effort, fit_words};
pub use given::NoSuchEffect;
pub use law::{Form, LAW_PARAMETERS, Law, Partials};
pub use library::Library;
pub use parameter::{Coordinate, Dimension, Domain, Parameter, Range, Scope};
pub use search_plan::{SearchPlan, Starts};
pub use slot::{SameSlot, Slot, check_slots};
pub use taylor_series::{MOST_TERMS, TaylorSeries};

/// Every effect.
pub const ALL: &[&dyn Effect] = &[
    &static_friction::StaticFriction,
    &stribeck::Stribeck,
    &viscous_asymmetry::ViscousAsymmetry,
    &quadratic_drag::QuadraticDrag,
    &presliding::Presliding,
    &friction_drift::FrictionDrift,
    &backlash::Backlash,
    &flexible_mode::FlexibleMode,
    &spring::Spring,
    &hardening_spring::HardeningSpring,
    &cogging::Cogging,
    &transport_delay::TransportDelay,
    &sensor_lag::SensorLag,
    &actuator_saturation::ActuatorSaturation,
    &actuator_dead_zone::ActuatorDeadZone,
    &gain_asymmetry::GainAsymmetry,
    &slew_limit::SlewLimit,
];

/// The effect with this id.
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    ALL.iter().copied().find(|effect| effect.id() == id)
}

/// The effect and parameter reported under this name (`spring.stiffness`).
pub fn find_parameter(key: &str) -> Option<(&'static dyn Effect, &'static Parameter)> {
    let parameters = |effect: &&'static dyn Effect| {
        let effect = *effect;
        effect.parameters().iter().map(move |parameter| (effect, parameter))
    };
    ALL.iter().flat_map(parameters).find(|(effect, parameter)| effect.key(parameter) == key)
}

/// Whether either of two effects is listed as an imitator of the other.
pub fn are_confusable(one: &dyn Effect, other: &dyn Effect) -> bool {
    one.descriptor().imitators.contains(&other.id())
        || other.descriptor().imitators.contains(&one.id())
}

/// Whether each of two effects is the closest imitator of the other: the first in its list.
pub fn are_closest_imitators(one: &dyn Effect, other: &dyn Effect) -> bool {
    let closest = |effect: &dyn Effect| effect.descriptor().imitators.first().copied();
    closest(one) == Some(other.id()) && closest(other) == Some(one.id())
}

/// Whether one of two different effects has all parameters of the other, and so contains it as a
/// special case.
pub fn are_nested(one: &dyn Effect, other: &dyn Effect) -> bool {
    let has = |more: &dyn Effect, own: &Parameter| more.parameters().iter().any(|p| p.is_same(own));
    let within =
        |less: &dyn Effect, more: &dyn Effect| less.parameters().iter().all(|own| has(more, own));
    one.id() != other.id() && (within(one, other) || within(other, one))
}

/// Whether an effect is a special case of another, as a flexible mode is backlash without a gap.
pub fn is_special_case(special: &dyn Effect, general: &dyn Effect) -> bool {
    special.parameters().len() < general.parameters().len() && are_nested(special, general)
}

/// The axis made of a plant and effects, with derivatives. Each parameter of an effect is an
/// independent variable, in order from lane `first_lane` on. [`Effect::enter`] explains
/// `run_share`.
///
/// # Panics
/// If the parameters need more than [`WIDE_LANES`] lanes.
pub fn enter(
    plant: Plant<Wide>,
    effects: &[ActiveEffect],
    run_share: f64,
    first_lane: usize,
) -> Axis<Wide> {
    let mut axis = Axis::base(plant);
    let mut lane = first_lane;
    for active in effects {
        let parameters: Vec<Wide> =
            active.values().iter().zip(lane..).map(|(v, lane)| Wide::variable(*v, lane)).collect();
        lane += parameters.len();
        active.effect().enter(&parameters, run_share, &mut axis);
    }
    axis
}

/// Like [`enter`], without derivatives.
pub fn enter_values(plant: Plant, effects: &[ActiveEffect], run_share: f64) -> Axis {
    if effects.is_empty() {
        return Axis::base(plant);
    }
    let mut axis = Axis::base(plant.map(Wide::constant));
    for active in effects {
        let parameters: Vec<Wide> = active.values().iter().copied().map(Wide::constant).collect();
        active.effect().enter(&parameters, run_share, &mut axis);
    }
    axis.map(Scalar::value)
}

#[cfg(test)]
mod tests;
