//! a becomes a(1 + α) for v > 0 and a(1 − α) for v < 0.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "viscous_asymmetry",
    parameters: &[("alpha", Requirement::BelowOneInSize)],
    enter: |p, parts| parts.viscous_asymmetry = p[0],
};
