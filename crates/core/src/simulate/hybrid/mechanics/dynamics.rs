//! The equations of motion in one mode: the derivative of the state by time.

use crate::plant::Scalar;

use super::super::runge_kutta::Vector;
use super::{Contact, Mechanics, Mode, NonlinearTorque, VELOCITY};
use crate::simulate::base::switching_times::Motion;

impl<S: Scalar> Mechanics<S> {
    /// By how much the net torque exceeds the level that friction can hold: forward, backward.
    /// Positive at breakaway.
    pub fn excess<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> [S; 2] {
        let net = self.net(contact, torque, state);
        let [forward, backward] = self.holding_levels();
        [net - forward, backward - net]
    }

    /// τ − g − T_s: everything but friction and damping, input units.
    #[inline(always)]
    pub(super) fn net<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> S {
        self.linear_net(contact, torque - self.nonlinear_torque(state), state)
    }

    /// Sum of the nonlinear torques.
    #[inline(always)]
    fn nonlinear_torque<const M: usize>(&self, state: &Vector<S, M>) -> S {
        let position = self.position.map_or(S::constant(0.0), |i| state[i]);
        let mut sum = S::constant(0.0);
        for NonlinearTorque { law, .. } in &self.nonlinear {
            sum += law.at(state[VELOCITY], position);
        }
        sum
    }

    /// τ − g − T_s without the nonlinear torques.
    #[inline(always)]
    fn linear_net<const M: usize>(&self, contact: Contact, torque: S, state: &Vector<S, M>) -> S {
        let mut net = torque + self.balance;
        let v = state[VELOCITY];
        let position = self.position.map_or(S::constant(0.0), |i| state[i]);
        for law in &self.linear {
            net -= law.at(v, position);
        }
        net - self.joint(contact, state)
    }

    /// Torque T_s of the joint: k·(φ beyond the gap) + c·(v − v_load) in contact, 0 inside the gap.
    #[inline(always)]
    fn joint<const M: usize>(&self, contact: Contact, state: &Vector<S, M>) -> S {
        let Some(mass) = self.second_mass else { return S::constant(0.0) };
        let twist = state[self.twist];
        let beyond = match contact {
            Contact::Open => return S::constant(0.0),
            Contact::Linked => twist,
            Contact::Upper => twist - mass.gap * 0.5,
            Contact::Lower => twist + mass.gap * 0.5,
        };
        mass.stiffness * beyond + mass.damping * (state[VELOCITY] - state[self.load_velocity])
    }

    /// Derivative of the state by time.
    #[inline(always)]
    pub fn slope<const M: usize>(
        &self,
        mode: Mode,
        torque: S,
        state: &Vector<S, M>,
    ) -> Vector<S, M> {
        let nonlinear = match mode.motion {
            Motion::Stuck => S::constant(0.0),
            _ => self.nonlinear_torque(state),
        };
        self.linear_slope(mode, torque - nonlinear, state)
    }

    /// The same without the nonlinear torques.
    #[inline(always)]
    pub fn linear_slope<const M: usize>(
        &self,
        mode: Mode,
        torque: S,
        state: &Vector<S, M>,
    ) -> Vector<S, M> {
        let mut slope = [S::constant(0.0); M];
        let v = state[VELOCITY];
        let direction = usize::from(mode.motion == Motion::Backward);
        if mode.motion != Motion::Stuck {
            let mut driving = self.linear_net(mode.contact, torque, state);
            let mut level = self.level(mode);
            if let Some(curve) = &self.curve {
                level = level * curve.at(v, S::constant(0.0));
            }
            match self.bristle.filter(|_| !mode.yields) {
                Some(sigma) => {
                    let bristle = state[self.bristle_at];
                    driving -= sigma * bristle;
                    // |v|/Fc(sgn v) equals v divided by the signed level.
                    slope[self.bristle_at] = v - v * sigma * bristle / level;
                }
                _ => driving -= level,
            }
            let mut acceleration = driving * self.constant - v * self.viscous_rate[direction];
            if let Some(mass) = self.second_mass {
                acceleration = acceleration / (-mass.load_inertia_fraction + 1.0);
            }
            slope[VELOCITY] = acceleration;
        }
        if let Some(i) = self.position {
            slope[i] = v;
            if let Some(integral) = self.position_integral {
                slope[integral] = state[i];
            }
        }
        if let Some(mass) = self.second_mass {
            slope[self.load_velocity] =
                self.joint(mode.contact, state) * self.constant / mass.load_inertia_fraction;
            slope[self.twist] = v - state[self.load_velocity];
        }
        slope
    }

    /// Estimates of the sizes that the states reach under a torque of this amplitude and period.
    pub fn sizes<const M: usize>(&self, amplitude: f64, period_s: f64) -> [f64; M] {
        let time_s = period_s / std::f64::consts::TAU;
        let slowest = self.viscous_rate[0].value().min(self.viscous_rate[1].value());
        let v = amplitude * self.constant.value().abs() * time_s.min(1.0 / slowest);
        let v = v.max(f64::MIN_POSITIVE);
        let mut sizes = [v; M];
        if let Some(i) = self.position {
            sizes[i] = v * time_s;
        }
        if let Some(i) = self.position_integral {
            sizes[i] = v * time_s * time_s;
        }
        if let Some(sigma) = self.bristle {
            let longest = self.coulomb[0].value().max(-self.coulomb[1].value()) / sigma.value();
            sizes[self.bristle_at] = longest.clamp(f64::MIN_POSITIVE, v * time_s);
        }
        if let Some(mass) = self.second_mass {
            let elastic = amplitude / mass.stiffness.value();
            sizes[self.twist] = (elastic + mass.gap.value()).max(f64::MIN_POSITIVE);
        }
        sizes
    }
}
