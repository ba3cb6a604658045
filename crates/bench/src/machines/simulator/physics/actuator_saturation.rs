//! u clipped to ±limit.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "actuator_saturation",
    parameters: &[("limit", Requirement::Positive)],
    enter: |p, parts| parts.limit = p[0],
};
