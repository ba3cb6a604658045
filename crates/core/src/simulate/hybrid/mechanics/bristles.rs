//! Changes of an axis whose friction acts through bristles.

use crate::plant::Scalar;

use super::super::runge_kutta::Vector;
use super::{Mechanics, Mode, VELOCITY};
use crate::simulate::base::switching_times::Motion;

impl<S: Scalar> Mechanics<S> {
    /// Whether a bristle has just become fully deflected, to within the relative `tolerance`. The
    /// missing deflection decays as exp(−σ/Fc·travel). Only for friction that does not depend on
    /// |v|.
    pub fn yields<const M: usize>(&self, mode: Mode, state: &Vector<S, M>, tolerance: f64) -> bool {
        let Some(sigma) = self.bristle.filter(|_| !mode.yields && self.curve.is_none()) else {
            return false;
        };
        let level = self.level(mode).value();
        (sigma.value() * state[self.bristle_at].value() - level).abs() < tolerance * level.abs()
    }

    /// Deflects the bristle fully.
    pub fn deflect_fully<const M: usize>(&self, mode: Mode, state: &mut Vector<S, M>) {
        if let Some(sigma) = self.bristle {
            state[self.bristle_at] = self.level(mode) / sigma;
        }
    }

    /// Starts an axis that has been at rest on its bristles: sets the deflection z at which they
    /// balance the net torque, and the velocity at which they go on to balance it while the torque
    /// changes at `torque_rate`: σ·v·(1 − σz/Fc) = τ'. No effect without bristles.
    pub fn leave_rest_on_bristles<const M: usize>(
        &self,
        mode: Mode,
        torque: S,
        torque_rate: S,
        state: &mut Vector<S, M>,
    ) {
        let Some(sigma) = self.bristle else { return };
        let net = self.net(mode.contact, torque, state);
        let level = self.coulomb[usize::from(mode.motion == Motion::Backward)];
        state[self.bristle_at] = net / sigma;
        state[VELOCITY] = torque_rate / (sigma * (-(net / level) + 1.0));
    }
}
