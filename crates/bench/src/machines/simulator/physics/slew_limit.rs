//! A rate limiter in its periodic state: w' = ±rate until w meets u again, w = u while |u'| ≤ rate.

use super::{Physics, Requirement};

pub(super) const PHYSICS: Physics = Physics {
    id: "slew_limit",
    parameters: &[("rate", Requirement::Positive)],
    enter: |p, parts| parts.slew_rate = Some(p[0]),
};
