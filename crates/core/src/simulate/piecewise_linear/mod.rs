//! Axes that are linear between switches but not base models: static maps bend the input, a rate
//! limiter follows it, or the damping depends on the direction.
//!
//! `drive` gives the torque behind the actuator as a piecewise quintic, `stick_slip_motion` the
//! exact motion under it, and `stick_slip_periodic` closes that motion to a period.

pub(super) mod drive;
mod rate_limit;
pub(super) mod stick_slip_motion;
pub(super) mod stick_slip_periodic;
