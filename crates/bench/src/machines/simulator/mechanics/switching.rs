//! Conditions for switching between the modes of motion and contact.

use super::{Contact, Mechanics, Mode, Motion, VELOCITY};

impl Mechanics {
    /// The mode that applies from `state` on.
    pub(in super::super) fn mode<const N: usize>(&self, torque: f64, state: &[f64; N]) -> Mode {
        let contact = self.contact(state);
        let motion = match state[VELOCITY] {
            0.0 => self.at_zero(contact, torque, state),
            v => Motion::Sliding(v.signum()),
        };
        Mode { motion, contact }
    }

    /// The motion of an axis at v = 0: it sticks unless the torque exceeds the static level. With
    /// a bristle it never sticks.
    pub(in super::super) fn at_zero<const N: usize>(
        &self,
        contact: Contact,
        torque: f64,
        state: &[f64; N],
    ) -> Motion {
        let net = self.net_torque(contact, torque, state);
        if let Some((bristle, sigma)) = self.bristle {
            return Motion::Sliding(if net < sigma * state[bristle] { -1.0 } else { 1.0 });
        }
        let factor = self.outside.map_or(1.0, |outside| outside.friction_factor(torque));
        if net > factor * self.friction.levels.fs_plus {
            Motion::Sliding(1.0)
        } else if net < -factor * self.friction.levels.fs_minus {
            Motion::Sliding(-1.0)
        } else {
            Motion::Stuck
        }
    }

    /// Whether the current motion has ended: a sliding axis has reached or passed v = 0, or the
    /// torque on a sticking axis exceeds the static level.
    #[inline]
    pub(in super::super) fn motion_is_over<const N: usize>(
        &self,
        mode: Mode,
        torque: f64,
        state: &[f64; N],
    ) -> bool {
        match mode.motion {
            Motion::Sliding(direction) => direction * state[VELOCITY] <= 0.0,
            Motion::Stuck => self.at_zero(mode.contact, torque, state) != Motion::Stuck,
        }
    }

    /// Whether the twist of the joint has entered or left the gap.
    #[inline]
    pub(in super::super) fn contact_is_over<const N: usize>(
        &self,
        mode: Mode,
        state: &[f64; N],
    ) -> bool {
        N > 2 && self.joint.is_some_and(|joint| joint.is_over(mode.contact, state))
    }

    /// Sets the twist exactly to the edge of the gap, and returns the contact state after the
    /// event.
    pub(in super::super) fn at_edge<const N: usize>(
        &self,
        contact: Contact,
        state: &mut [f64; N],
    ) -> Contact {
        self.joint.map_or(contact, |joint| joint.at_edge(contact, state))
    }

    fn contact<const N: usize>(&self, state: &[f64; N]) -> Contact {
        self.joint.map_or(Contact::Free, |joint| joint.contact(state))
    }
}
