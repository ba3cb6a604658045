//! Static levels above the Coulomb levels, at v = 0 only.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "static_friction",
    parameters: &[("fs_plus", Requirement::NotNegative), ("fs_minus", Requirement::NotNegative)],
    enter: |p, parts| parts.static_levels = Some([p[0], p[1]]),
};
