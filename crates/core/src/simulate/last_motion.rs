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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{ActiveEffect, find};
    use crate::measurement::Complex;
    use crate::plant::{Actuator, Friction, Plant};
    use crate::simulate::{Counts, Excitation, respond, respond_if};

    fn plant(viscous_rate_rad_s: f64) -> Plant {
        let friction = Friction::coulomb(0.5, 0.4);
        Plant { viscous_rate_rad_s, constant: 10.0, actuator: Actuator::Direct, friction }
    }

    fn axis(id: &str, values: &[f64]) -> Vec<ActiveEffect> {
        vec![ActiveEffect::new(find(id).unwrap(), values.to_vec()).unwrap()]
    }

    fn apart(here: &[Complex], there: &[Complex]) -> f64 {
        let largest = there.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let apart = here.iter().zip(there).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        apart / largest
    }

    // `respond` errs by 1e-5 of the largest response, 3e-5 with backlash.
    #[test]
    fn the_motion_found_from_the_last_one_is_the_one_reached_from_rest() {
        let excitation = Excitation::cosine(3.0, 2.0);
        for (id, values) in [
            ("flexible_mode", vec![0.3, 20.0, 0.2]),
            ("backlash", vec![0.3, 20.0, 0.2, 0.02]),
            ("quadratic_drag", vec![0.05]),
        ] {
            let last = LastMotion::default();
            for rate in [10.0, 10.5, 13.0] {
                let (plant, effects) = (plant(rate), axis(id, &values));
                let near = respond_if(Counts::Near(&last), &plant, &effects, &excitation, 7);
                let from_rest = respond(&plant, &effects, &excitation, 7).unwrap();
                let apart = apart(&near.unwrap(), &from_rest);
                assert!(apart < 6e-5, "{id}, rate {rate}: {apart}");
            }
            assert!(last.0.lock().unwrap().is_some(), "{id}");
        }
    }

    #[test]
    fn a_motion_of_an_axis_with_other_states_is_no_beginning() {
        let (plant, excitation, last) =
            (plant(10.0), Excitation::cosine(3.0, 2.0), LastMotion::default());
        let joint = axis("flexible_mode", &[0.3, 20.0, 0.2]);
        respond_if(Counts::Near(&last), &plant, &joint, &excitation, 7).unwrap();
        let drag = axis("quadratic_drag", &[0.05]);
        let near = respond_if(Counts::Near(&last), &plant, &drag, &excitation, 7).unwrap();
        assert!(apart(&near, &respond(&plant, &drag, &excitation, 7).unwrap()) < 1e-12);
    }
}
