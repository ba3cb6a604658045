//! Axes that are linear between switches but are not base models: with static maps of the input, a
//! rate limiter, or damping that depends on the direction.
//!
//! `drive` computes the torque behind the actuator as a piecewise quintic (with `rate_limit`),
//! `stick_slip_motion` the exact motion under it, and `stick_slip_periodic` the periodic motion.

pub(super) mod drive;
mod rate_limit;
pub(super) mod stick_slip_motion;
pub(super) mod stick_slip_periodic;
