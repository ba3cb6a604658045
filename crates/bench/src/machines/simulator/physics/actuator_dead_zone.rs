//! u − clip(u, ±half width).

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "actuator_dead_zone",
    parameters: &[("half_width", Requirement::NotNegative)],
    enter: |p, parts| parts.dead_zone = p[0],
};
