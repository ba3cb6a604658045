//! f(v) = sgn(v)·Fc·[1 + (r − 1)·exp(−(v/vs)²)], breakaway at the larger of r·Fc and Fs.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "stribeck",
    parameters: &[
        ("fs_over_fc", Requirement::AtLeastOne),
        ("stribeck_velocity", Requirement::Positive),
    ],
    enter: |p, parts| parts.stribeck = Some([p[0] - 1.0, p[1]]),
};
