//! Equations of motion behind the actuator, and the law of dry friction.

use crate::plant::{Friction, Plant};

/// Number of states.
pub(super) const STATES: usize = 1;
/// Index of v, response units.
pub(super) const VELOCITY: usize = 0;
/// What moves.
pub(super) type State = [f64; STATES];

/// What friction does at the moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Motion {
    /// It holds the axis at v = 0.
    Stuck,
    /// It opposes motion in this direction, +1 or −1; v may still be 0.
    Sliding(f64),
}

/// v' = −a v + K (τ − f − g).
#[derive(Debug, Clone, Copy)]
pub(super) struct Mechanics {
    viscous_rate_rad_s: f64,
    constant: f64,
    friction: Friction,
}

impl Mechanics {
    pub(super) fn of(plant: &Plant) -> Self {
        Self {
            viscous_rate_rad_s: plant.viscous_rate_rad_s,
            constant: plant.constant,
            friction: plant.friction,
        }
    }

    /// τ − g, input units: what friction has to balance at rest. The base model has no
    /// other torque g.
    fn net_torque(&self, torque: f64, _state: &State) -> f64 {
        torque
    }

    /// f while sliding, input units.
    fn kinetic_friction(&self, direction: f64) -> f64 {
        if direction > 0.0 { self.friction.fc_plus } else { -self.friction.fc_minus }
    }

    /// Time derivative of the state.
    pub(super) fn slope(&self, motion: Motion, torque: f64, state: State) -> State {
        let Motion::Sliding(direction) = motion else { return [0.0] };
        let driving = self.net_torque(torque, &state) - self.kinetic_friction(direction);
        [self.constant * driving - self.viscous_rate_rad_s * state[VELOCITY]]
    }

    /// How friction meets an axis at v = 0: it holds it unless the torque exceeds the
    /// static level.
    pub(super) fn at_zero(&self, torque: f64, state: &State) -> Motion {
        let net = self.net_torque(torque, state);
        if net > self.friction.fs_plus {
            Motion::Sliding(1.0)
        } else if net < -self.friction.fs_minus {
            Motion::Sliding(-1.0)
        } else {
            Motion::Stuck
        }
    }

    /// Whether the motion has come to its end: sliding at v = 0 or beyond, sticking
    /// where the torque exceeds the static level.
    pub(super) fn is_over(&self, motion: Motion, torque: f64, state: &State) -> bool {
        match motion {
            Motion::Sliding(direction) => direction * state[VELOCITY] <= 0.0,
            Motion::Stuck => self.at_zero(torque, state) != Motion::Stuck,
        }
    }
}
