//! A torque c·v·|v|.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "quadratic_drag",
    parameters: &[("c", Requirement::NotNegative)],
    enter: |p, parts| parts.quadratic_drag = p[0],
};
