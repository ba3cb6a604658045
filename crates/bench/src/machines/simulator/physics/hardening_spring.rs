//! A torque k·θ + k₃·θ³, θ = 0 at rest.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "hardening_spring",
    parameters: &[
        ("stiffness", Requirement::NotNegative),
        ("cubic_stiffness", Requirement::NotNegative),
    ],
    enter: |p, parts| parts.add_spring(p[0], p[1]),
};
