//! T·y' + y = v.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "sensor_lag",
    parameters: &[("time_constant", Requirement::NotNegative)],
    enter: |p, parts| parts.sensor_lag_s = Some(p[0]),
};
