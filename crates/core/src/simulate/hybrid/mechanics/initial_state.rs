//! The state vector at the beginning of a transient, from the quantities that the user gives.

use crate::plant::Scalar;

use super::{Contact, Mechanics, VELOCITY};
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::transient::motion::InitialState;

impl<S: Scalar> Mechanics<S> {
    /// The initial state under an initial torque. Quantities that are not given have the values of
    /// a motion at constant velocity, in which the bristle is fully deflected. For an axis at rest
    /// the bristle balances the torque as far as it can.
    pub fn start<const M: usize>(&self, torque: S, initial: &InitialState) -> Vector<S, M> {
        let mut state = [S::constant(0.0); M];
        let v = initial.velocity;
        state[VELOCITY] = S::constant(v);
        if let Some(i) = self.position {
            state[i] = S::constant(initial.position);
        }
        let side = if v == 0.0 { 0.0 } else { v.signum() };
        if let Some(mass) = self.second_mass {
            let twist = initial.twist.unwrap_or(0.5 * side * mass.gap.value());
            state[self.load_velocity] = S::constant(v);
            state[self.twist] = S::constant(twist);
        }
        if let Some(sigma) = self.bristle {
            let [forward, backward] = self.coulomb;
            let balanced = self.net(Contact::Open, torque, &state);
            let toward = |share: f64| if share < 0.0 { backward * -share } else { forward * share };
            let level = match initial.bristle {
                Some(share) => toward(share),
                None if side != 0.0 => toward(side),
                None if balanced.value() > forward.value() => forward,
                None if balanced.value() < backward.value() => backward,
                None => balanced,
            };
            state[self.bristle_at] = level / sigma;
        }
        state
    }
}
