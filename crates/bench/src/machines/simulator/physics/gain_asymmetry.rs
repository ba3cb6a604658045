//! (1 + γ)u for u > 0, (1 − γ)u for u < 0.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "gain_asymmetry",
    parameters: &[("gamma", Requirement::BelowOneInSize)],
    enter: |p, parts| parts.gain_asymmetry = p[0],
};
