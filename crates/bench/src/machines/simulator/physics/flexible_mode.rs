//! Motor and load, inertia 1/K split (1 − ρ):ρ, joined by a spring and a damper; the motor's
//! velocity is measured.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "flexible_mode",
    parameters: &[
        ("load_inertia_fraction", Requirement::Share),
        ("stiffness", Requirement::Positive),
        ("damping", Requirement::NotNegative),
    ],
    enter: |p, parts| parts.joint = Some([p[0], p[1], p[2], 0.0]),
};
