//! u(t − T).

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "transport_delay",
    parameters: &[("delay", Requirement::NotNegative)],
    enter: |p, parts| parts.delay_s = p[0],
};
