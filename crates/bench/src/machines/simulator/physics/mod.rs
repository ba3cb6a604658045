//! The physics of each effect: one file each, and a line in [`ALL`].
//!
//! A file says which parameters its effect has, what they must be, and what they make of the
//! [`Parts`] of a machine. It stands beside the file of the same name in `servoscope-core`'s
//! `effects` and shares no code with it: one simulator checks the other. `outsiders` are physics
//! that no diagnosis has a name for.

mod actuator_dead_zone;
mod actuator_saturation;
mod backlash;
mod cogging;
mod flexible_mode;
mod friction_drift;
mod gain_asymmetry;
mod hardening_spring;
mod outsiders;
mod presliding;
mod quadratic_drag;
mod requirement;
mod sensor_lag;
mod slew_limit;
mod spring;
mod static_friction;
mod stribeck;
mod transport_delay;
mod viscous_asymmetry;

use super::parts::Parts;
use requirement::Requirement;

/// The physics of one effect.
#[derive(Debug)]
pub struct Physics {
    /// Its id.
    pub id: &'static str,
    /// Names of its parameters, and what they must be.
    pub parameters: &'static [(&'static str, Requirement)],
    /// Sets the parts of a machine that it changes, by the values of its parameters.
    pub enter: fn(&[f64], &mut Parts),
}

/// Every physics.
pub static ALL: &[Physics] = &[
    static_friction::PHYSICS,
    stribeck::PHYSICS,
    viscous_asymmetry::PHYSICS,
    quadratic_drag::PHYSICS,
    presliding::PHYSICS,
    friction_drift::PHYSICS,
    backlash::PHYSICS,
    flexible_mode::PHYSICS,
    spring::PHYSICS,
    hardening_spring::PHYSICS,
    cogging::PHYSICS,
    transport_delay::PHYSICS,
    sensor_lag::PHYSICS,
    actuator_saturation::PHYSICS,
    actuator_dead_zone::PHYSICS,
    gain_asymmetry::PHYSICS,
    slew_limit::PHYSICS,
    outsiders::CUBIC_DRAG,
    outsiders::FIELD_WEAKENING,
    outsiders::LOAD_DEPENDENT_FRICTION,
    outsiders::KINKED_VISCOSITY,
    outsiders::GAIN_DRIFT,
    outsiders::VISCOUS_DRIFT,
    outsiders::SENSOR_COMPRESSION,
    outsiders::INPUT_QUANTISATION,
];
