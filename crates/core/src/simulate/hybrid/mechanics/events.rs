//! The events that change the mode, and the signals that announce them.

use crate::plant::Scalar;

use super::super::runge_kutta::Vector;
use super::{Mechanics, Mode, VELOCITY};
use crate::simulate::base::switching_times::Motion;

/// Kinds of switches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) enum Event {
    /// v reaches zero.
    Stops,
    /// Breakaway, forward (0) or backward (1).
    Starts(usize),
    /// The twist φ reaches the upper (true) or lower end of the gap.
    Touches(bool),
    /// The contact at that end opens.
    Leaves(bool),
}

impl<S: Scalar> Mechanics<S> {
    /// The signal of an event: it becomes positive when the event happens.
    pub fn signal<const M: usize>(
        &self,
        event: Event,
        mode: Mode,
        torque: S,
        state: &Vector<S, M>,
    ) -> S {
        match event {
            Event::Stops if mode.motion == Motion::Forward => -state[VELOCITY],
            Event::Stops => state[VELOCITY],
            Event::Starts(direction) => self.excess(mode.contact, torque, state)[direction],
            Event::Touches(upper) => -self.clearance(upper, state),
            Event::Leaves(upper) => self.clearance(upper, state),
        }
    }
}
