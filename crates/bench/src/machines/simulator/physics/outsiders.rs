//! What a machine may have that no list of effects knows.
//!
//! A diagnosis that is shown one of these and names another has been deceived. All are
//! physics that occurs: worn oil, warm magnets, a coarse converter.

use super::{Physics, Requirement};

/// A torque c·v³, of a fan or of turbulent oil.
pub(super) const CUBIC_DRAG: Physics = Physics {
    id: "cubic_drag",
    parameters: &[("c", Requirement::NotNegative)],
    enter: |p, parts| parts.cubic_drag = p[0],
};

/// The torque falls with speed to τ/(1 + κ·v²), as a motor's in a weakened field.
pub(super) const FIELD_WEAKENING: Physics = Physics {
    id: "field_weakening",
    parameters: &[("kappa", Requirement::NotNegative)],
    enter: |p, parts| parts.field_weakening = p[0],
};

/// All friction levels × (1 + μ·|τ|), as where the drive's torque presses on a bearing.
pub(super) const LOAD_DEPENDENT_FRICTION: Physics = Physics {
    id: "load_dependent_friction",
    parameters: &[("mu", Requirement::NotNegative)],
    enter: |p, parts| parts.load_friction = p[0],
};

/// a becomes a(1 + β) for what |v| has beyond a knee, as where a seal begins to drag.
pub(super) const KINKED_VISCOSITY: Physics = Physics {
    id: "kinked_viscosity",
    parameters: &[("beta", Requirement::NotNegative), ("knee", Requirement::Positive)],
    enter: |p, parts| parts.viscous_kink = [p[0], p[1]],
};

/// The command's gain × (1 + δ·share of the run), as of magnets that warm up.
pub(super) const GAIN_DRIFT: Physics = Physics {
    id: "gain_drift",
    parameters: &[("delta", Requirement::AboveMinusOne)],
    enter: |p, parts| parts.gain_drift = p[0],
};

/// a × (1 + δ·share of the run), as of oil that warms up.
pub(super) const VISCOUS_DRIFT: Physics = Physics {
    id: "viscous_drift",
    parameters: &[("delta", Requirement::AboveMinusOne)],
    enter: |p, parts| parts.viscous_drift = p[0],
};

/// A sensor that reads v/√(1 + (e·v)²).
pub(super) const SENSOR_COMPRESSION: Physics = Physics {
    id: "sensor_compression",
    parameters: &[("e", Requirement::NotNegative)],
    enter: |p, parts| parts.compression = p[0],
};

/// The command rounded to whole steps, by a coarse converter.
pub(super) const INPUT_QUANTISATION: Physics = Physics {
    id: "input_quantisation",
    parameters: &[("step", Requirement::Positive)],
    enter: |p, parts| parts.quantum = Some(p[0]),
};
