//! Dahl's bristle z' = v − |v|·σ·z/Fc(sgn v), f = σ·z, in place of set-valued friction. Its level
//! Fc follows the Stribeck curve, where there is one; static levels have no effect beside it.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "presliding",
    parameters: &[("sigma", Requirement::Positive)],
    enter: |p, parts| parts.bristle_stiffness = Some(p[0]),
};
