//! The elastic joint of two masses, with or without a gap.

use super::VELOCITY;

/// What the joint between motor and load does at the moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) enum Contact {
    /// The twist is within the gap.
    Free,
    /// It is beyond the gap on this side, +1 or −1.
    At(f64),
}

/// The elastic joint of two masses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joint {
    /// ρ.
    pub(super) load_fraction: f64,
    /// k, input units per response unit and second.
    pub(super) stiffness: f64,
    /// c, input units per response unit.
    pub(super) damping: f64,
    /// Half of the gap, response units and seconds.
    pub(super) half_gap: f64,
    /// Index of φ; v_load follows it.
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

    /// The contact in which a state moves on.
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

    /// Whether an edge of the gap has been met or left.
    #[inline]
    pub(super) fn is_over<const N: usize>(&self, contact: Contact, state: &[f64; N]) -> bool {
        let twist = state[self.twist];
        self.half_gap > 0.0
            && match contact {
                Contact::Free => twist.abs() > self.half_gap,
                Contact::At(side) => side * twist < self.half_gap,
            }
    }

    /// The state at an edge of the gap, exactly, and the contact beyond it.
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
