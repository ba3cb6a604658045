//! Harmonics of a motion from its switching instants.
//!
//! x' = −a·x + τ − f holds at every instant, at rest too (there f = τ). So
//! Vₖ = K·(Tₖ − Fₖ)/(jkω + a), and Fₖ, the harmonic of the friction, is an
//! integral over phases in which f is either constant or equal to τ.

use crate::measurement::Complex;
use crate::plant::{Friction, Plant};

use super::orbit::{Motion, Orbit};

/// V₀ … V_H of a motion; `lines` are the torque lines T₀, T₁ …
pub(super) fn velocity(
    plant: &Plant,
    lines: &[Complex],
    orbit: &Orbit,
    highest: usize,
) -> Vec<Complex> {
    let zero = Complex::new(0.0, 0.0);
    if !orbit.switches() && orbit.phases[0].motion == Motion::Stuck {
        return vec![zero; highest + 1];
    }
    let omega = std::f64::consts::TAU / orbit.period_s;
    let spans = PhaseIntegrals::new(orbit, highest, lines.len() - 1);
    let held = spans.held(lines);
    (0..=highest)
        .map(|k| {
            let friction = plant.friction.fc_plus * spans.forward[k]
                - plant.friction.fc_minus * spans.backward[k]
                + held[k];
            let torque = lines.get(k).copied().unwrap_or(zero);
            let torque = if k == 0 { Complex::new(torque.re, 0.0) } else { torque };
            (torque - friction * weight(k, orbit.period_s)) * plant.constant
                / Complex::new(plant.viscous_rate_rad_s, k as f64 * omega)
        })
        .collect()
}

/// Factor from ∫ g exp(−jkωt) dt to the harmonic Gₖ of g.
pub(super) fn weight(k: usize, period_s: f64) -> f64 {
    if k == 0 { 1.0 / period_s } else { 2.0 / period_s }
}

/// Friction while sliding; what it is at rest the torque decides.
pub(super) fn sliding_friction(friction: &Friction, motion: Motion) -> Option<f64> {
    match motion {
        Motion::Forward => Some(friction.fc_plus),
        Motion::Backward => Some(-friction.fc_minus),
        Motion::Stuck => None,
    }
}

/// ∫ exp(−jkωt) dt over all phases of each motion, k = 0, 1 …
pub(super) struct PhaseIntegrals {
    /// Over the forward phases, k = 0 … H, seconds.
    pub forward: Vec<Complex>,
    /// Over the backward phases, k = 0 … H, seconds.
    pub backward: Vec<Complex>,
    /// Over the stuck phases, k = 0 … H + L; empty where there are none.
    stuck: Vec<Complex>,
    highest: usize,
}

impl PhaseIntegrals {
    /// For harmonics up to `highest` and torque lines up to `highest_line`.
    pub fn new(orbit: &Orbit, highest: usize, highest_line: usize) -> Self {
        let omega = std::f64::consts::TAU / orbit.period_s;
        let zero = Complex::new(0.0, 0.0);
        let mut forward = vec![zero; highest + 1];
        let mut backward = vec![zero; highest + 1];
        let stuck_length = if orbit.sticks() { highest + highest_line + 1 } else { 0 };
        let mut stuck = vec![zero; stuck_length];
        for i in 0..orbit.phases.len() {
            let (start, end, motion) = orbit.span(i);
            let sums = match motion {
                Motion::Forward => &mut forward,
                Motion::Backward => &mut backward,
                Motion::Stuck => &mut stuck,
            };
            sums[0] += end - start;
            if !orbit.switches() {
                continue; // over a whole period every other harmonic vanishes
            }
            let (start_turn, end_turn) =
                (Complex::from_polar(1.0, -omega * start), Complex::from_polar(1.0, -omega * end));
            let (mut at_start, mut at_end) = (start_turn, end_turn);
            for (k, sum) in sums.iter_mut().enumerate().skip(1) {
                let difference = at_start - at_end;
                let scale = 1.0 / (k as f64 * omega);
                *sum += Complex::new(difference.im * scale, -difference.re * scale);
                at_start *= start_turn;
                at_end *= end_turn;
            }
        }
        Self { forward, backward, stuck, highest }
    }

    /// ∫ τ exp(−jkωt) dt over the stuck phases, k = 0 … H, for the signal
    /// τ = Re Σ Tₗ exp(jlωt).
    pub fn held(&self, lines: &[Complex]) -> Vec<Complex> {
        let mut held = vec![Complex::new(0.0, 0.0); self.highest + 1];
        if self.stuck.is_empty() {
            return held;
        }
        let over_stuck = |n: isize| {
            let value = self.stuck[n.unsigned_abs()];
            if n < 0 { value.conj() } else { value }
        };
        for (l, line) in lines.iter().enumerate() {
            if line.re == 0.0 && line.im == 0.0 {
                continue;
            }
            for (k, sum) in held.iter_mut().enumerate() {
                let (k, l) = (k as isize, l as isize);
                *sum += if l == 0 {
                    line.re * over_stuck(k)
                } else {
                    0.5 * (line * over_stuck(k - l) + line.conj() * over_stuck(k + l))
                };
            }
        }
        held
    }
}
