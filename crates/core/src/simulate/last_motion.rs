//! Where the periodic motion of an experiment began when it was last simulated.
//!
//! A fit simulates one axis after another that hardly differ. The motion of one is then so near to
//! that of the next that Newton's method needs a step or two from there, instead of the periods
//! from rest and the steps after them.

use std::sync::{Mutex, PoisonError};

/// Most states of an axis: v, θ, ∫θ dt, deflection of the bristle, velocity of the load, and twist of
/// the joint.
pub(super) const MOST_STATES: usize = 6;

/// The beginning of a periodic motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beginning {
    /// Number of states.
    pub states: usize,
    /// The unknowns of the return map.
    pub state: [f64; MOST_STATES],
    /// Sizes of the unknowns, and of the states.
    pub sizes: [[f64; MOST_STATES]; 2],
}

/// The beginning of the last motion of an experiment; none before the first simulation.
#[derive(Debug, Default)]
pub struct LastMotion(Mutex<Option<Beginning>>);

impl LastMotion {
    /// The beginning of the last motion, if it was one of so many states.
    pub(super) fn beginning(&self, states: usize) -> Option<Beginning> {
        let last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        last.filter(|beginning| beginning.states == states)
    }

    /// Remembers the beginning of a motion.
    pub(super) fn remember(&self, beginning: Beginning) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(beginning);
    }
}
