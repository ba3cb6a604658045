//! The elastic joint between motor and load, with or without a gap.

use super::VELOCITY;

/// Contact state of the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) enum Contact {
    /// The twist is within the gap.
    Free,
    /// The twist is beyond the gap on this side, +1 or −1.
    At(f64),
}

/// The elastic joint between motor and load.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joint {
    /// ρ.
    pub(super) load_fraction: f64,
    /// k, input units/(response unit·s).
    pub(super) stiffness: f64,
    /// c, input units per response unit.
    pub(super) damping: f64,
    /// Half of the gap, response units·s.
    pub(super) half_gap: f64,
    /// Index of the state φ; v_load is the next state.
    pub(super) twist: usize,
}

impl Joint {
    /// v − v_load.
    #[inline]
    fn rate<const N: usize>(&self, state: &[f64; N]) -> f64 {
        state[VELOCITY] - state[self.twist + 1]
    }

    /// Tₛ, input units.
    #[inline]
    pub(super) fn torque<const N: usize>(&self, contact: Contact, state: &[f64; N]) -> f64 {
        let Contact::At(side) = contact else { return 0.0 };
        let beyond = state[self.twist] - side * self.half_gap;
        self.stiffness * beyond + self.damping * self.rate(state)
    }

    /// The contact state that applies from `state` on.
    pub(super) fn contact<const N: usize>(&self, state: &[f64; N]) -> Contact {
        let twist = state[self.twist];
        let outwards = twist.signum() * self.rate(state);
        let beyond = twist.abs() - self.half_gap;
        if self.half_gap == 0.0 {
            Contact::At(1.0)
        } else if beyond > 0.0 || (beyond == 0.0 && outwards > 0.0) {
            Contact::At(twist.signum())
        } else {
            Contact::Free
        }
    }

    /// Whether the twist has entered or left the gap, so that `contact` no longer applies.
    #[inline]
    pub(super) fn is_over<const N: usize>(&self, contact: Contact, state: &[f64; N]) -> bool {
        let twist = state[self.twist];
        self.half_gap > 0.0
            && match contact {
                Contact::Free => twist.abs() > self.half_gap,
                Contact::At(side) => side * twist < self.half_gap,
            }
    }

    /// Sets the twist exactly to the edge of the gap, and returns the contact state after the
    /// event.
    pub(super) fn at_edge<const N: usize>(
        &self,
        contact: Contact,
        state: &mut [f64; N],
    ) -> Contact {
        let twist = &mut state[self.twist];
        match contact {
            Contact::Free => {
                *twist = self.half_gap.copysign(*twist);
                Contact::At(twist.signum())
            }
            Contact::At(side) => {
                *twist = side * self.half_gap;
                Contact::Free
            }
        }
    }
}
