//! A torque k·θ, θ = 0 at rest.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "spring",
    parameters: &[("stiffness", Requirement::NotNegative)],
    enter: |p, parts| parts.add_spring(p[0], 0.0),
};
