//! Derivatives of the harmonics by implicit differentiation of the switching times.
//!
//! A slide with friction σ from t_s to t_e ends where g = w(t_e) − w(t_s)·E − σ·(1 − E)/a = 0. Here
//! E = exp(−a(t_e − t_s)), and w is the steady response of 1/(s + a) to τ. A phase of rest ends
//! where τ meets the static level. Differentiating these equations gives the derivative of each
//! switching time as a linear function of the one before. Around the period they close to one
//! linear equation for the first. The cost is linear in the number of switches.

mod direction;
mod instants;

use crate::measurement::Complex;

use super::Settled;
use super::spectrum::{self, PhaseIntegrals, weight};
pub(crate) use direction::{Direction, actuator_derivatives, by_lane, parameter_directions};
use instants::Instants;

/// A motion whose harmonics are differentiated.
pub(crate) struct Differentiable<'a> {
    settled: Settled<'a>,
    /// V₀ … V_H.
    pub velocity: Vec<Complex>,
    integrals: PhaseIntegrals,
    instants: Instants,
}

impl<'a> Differentiable<'a> {
    /// The harmonics 0 … `highest` of a motion.
    pub fn new(settled: Settled<'a>, highest: usize) -> Self {
        let integrals = settled.integrals(highest);
        let velocity = spectrum::of_phases(&settled, &integrals, highest);
        let instants = Instants::new(&settled);
        Self { settled, velocity, integrals, instants }
    }

    /// Derivatives of V₀ … V_H, one row per direction.
    pub fn along(&self, directions: &[Direction]) -> Vec<Vec<Complex>> {
        let Self { settled, velocity, integrals, instants } = self;
        let Settled { plant, orbit, .. } = settled;
        if settled.rests() {
            return vec![vec![Complex::ZERO; velocity.len()]; directions.len()];
        }
        let omega = std::f64::consts::TAU / orbit.period_s;
        let highest = velocity.len() - 1;
        let sticks = orbit.sticks();
        let held = |direction: &Direction| match direction.lines.is_empty() || !sticks {
            true => vec![Complex::ZERO; velocity.len()],
            false => settled.held_of(&direction.lines, integrals, highest),
        };
        let mut friction: Vec<Vec<Complex>> = directions.iter().map(held).collect();
        instants.add_moves(settled, directions, &mut friction);
        let moving = directions.iter().zip(&mut friction);
        for (direction, friction) in moving.filter(|(direction, _)| direction.moves(sticks)) {
            // The change of the friction becomes that of the velocity.
            for (k, change) in friction.iter_mut().enumerate() {
                let torque = direction.lines.get(k).copied().unwrap_or_default();
                let torque = if k == 0 { Complex::new(torque.re, 0.0) } else { torque };
                let friction = *change + direction.fc_plus * integrals.forward[k]
                    - direction.fc_minus * integrals.backward[k];
                let by_forces = (torque - friction * weight(k, orbit.period_s)) * plant.constant;
                *change = (by_forces - velocity[k] * direction.viscous_rate)
                    / Complex::new(plant.viscous_rate_rad_s, k as f64 * omega);
            }
        }
        friction
    }
}
