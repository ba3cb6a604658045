//! The modes of the mechanics, and the mode that a state is in.

use crate::plant::Scalar;

use super::{Mechanics, VELOCITY};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::runge_kutta::Vector;

/// Contact in the joint to a second mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Contact {
    /// Always in contact, as there is no gap; or no second mass.
    Linked,
    /// Inside the gap.
    Open,
    /// At its upper end, φ ≥ gap/2.
    Upper,
    /// At its lower end, φ ≤ −gap/2.
    Lower,
}

/// Once the oscillations on the bristles are left out, the axis counts as at rest while the torque
/// stays below this share of the Coulomb level. Tuned.
const BRISTLE_HOLDING_SHARE: f64 = 0.9;

/// Which of the equations of motion hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct Mode {
    pub motion: Motion,
    pub contact: Contact,
    /// Whether the bristle is fully deflected: its force is then constant until v reverses.
    pub yields: bool,
}

impl<S: Scalar> Mechanics<S> {
    /// The mode in a state, if the mode before is not known.
    pub fn mode_at<const M: usize>(&self, torque: S, state: &Vector<S, M>) -> Mode {
        let contact = match self.half_gap() {
            None => Contact::Linked,
            Some(half) => match state[self.twist].value() {
                twist if twist > half => Contact::Upper,
                twist if twist < -half => Contact::Lower,
                _ => Contact::Open,
            },
        };
        let motion = match state[VELOCITY].value() {
            v if v > 0.0 => Motion::Forward,
            v if v < 0.0 => Motion::Backward,
            _ => self.motion_at_rest(contact, torque, state),
        };
        Mode { motion, contact, yields: false }
    }

    /// The motion that follows v = 0.
    pub fn motion_at_rest<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> Motion {
        let Some(sigma) = self.bristle else { return self.motion_if_stuck(contact, torque, state) };
        // A bristle does not hold the axis: the net force accelerates it one way or the other.
        let bristle_force = sigma * state[self.bristle_at];
        match self.net(contact, torque, state).value() < bristle_force.value() {
            true => Motion::Backward,
            false => Motion::Forward,
        }
    }

    /// Net torques up to which friction holds the axis at rest: forward, backward.
    pub(super) fn holding_levels(&self) -> [S; 2] {
        match self.bristle {
            Some(_) => self.coulomb.map(|level| level * BRISTLE_HOLDING_SHARE),
            None => self.breakaway,
        }
    }

    /// The motion of an axis that friction has held at rest so far.
    pub fn motion_if_stuck<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> Motion {
        let net = self.net(contact, torque, state).value();
        match self.holding_levels().map(S::value) {
            [forward, _] if net > forward => Motion::Forward,
            [_, backward] if net < backward => Motion::Backward,
            _ => Motion::Stuck,
        }
    }
}
