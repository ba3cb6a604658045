//! All friction levels × (1 + δ·share of the run).

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "friction_drift",
    parameters: &[("delta", Requirement::AboveMinusOne)],
    enter: |p, parts| parts.friction_drift = p[0],
};
