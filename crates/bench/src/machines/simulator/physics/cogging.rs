//! A torque T·sin(N·θ + φ), together with the constant torque that makes the mean of v zero; θ has
//! zero mean.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "cogging",
    parameters: &[
        ("amplitude", Requirement::NotNegative),
        ("cycles_per_unit", Requirement::Positive),
        ("phase", Requirement::Any),
    ],
    enter: |p, parts| parts.cogging = Some([p[0], p[1], p[2]]),
};
