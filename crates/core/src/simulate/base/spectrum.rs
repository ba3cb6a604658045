//! Harmonics of a periodic motion from its switching times.
//!
//! x' = −a·x + τ − f holds at all times, also at rest, where f = τ. Hence
//! Vₖ = K·(Tₖ − Fₖ)/(jkω + a), with Tₖ and Fₖ the harmonics of torque and friction. Fₖ is a sum of
//! integrals over the phases, in each of which f is either constant or equal to τ.

use crate::measurement::Complex;
use crate::plant::{Friction, Scalar};

use super::Settled;
use super::switching_times::{Motion, SwitchingTimes};
use super::turns;

/// Velocity harmonics V₀ … V_H of a periodic motion.
pub(crate) fn velocity(settled: &Settled<'_>, highest: usize) -> Vec<Complex> {
    of_phases(settled, &settled.integrals(highest), highest)
}

/// The same, given the integrals over its phases.
pub(super) fn of_phases(
    settled: &Settled<'_>,
    spans: &PhaseIntegrals,
    highest: usize,
) -> Vec<Complex> {
    let Settled { plant, lines, orbit, .. } = settled;
    if settled.rests() {
        return vec![Complex::ZERO; highest + 1];
    }
    let omega = std::f64::consts::TAU / orbit.period_s;
    let held = if orbit.sticks() { settled.held(spans, highest) } else { Vec::new() };
    (0..=highest)
        .map(|k| {
            let friction = plant.friction.fc_plus * spans.forward[k]
                - plant.friction.fc_minus * spans.backward[k]
                + held.get(k).copied().unwrap_or_default();
            let torque = lines.get(k).copied().unwrap_or_default();
            let torque = if k == 0 { Complex::new(torque.re, 0.0) } else { torque };
            (torque - friction * weight(k, orbit.period_s)) * plant.constant
                / Complex::new(plant.viscous_rate_rad_s, k as f64 * omega)
        })
        .collect()
}

/// Factor by which ∫ g exp(−jkωt) dt over a period gives the harmonic Gₖ of g.
pub(crate) fn weight(k: usize, period_s: f64) -> f64 {
    if k == 0 { 1.0 / period_s } else { 2.0 / period_s }
}

/// Friction while sliding; `None` at rest, where it equals the torque.
pub(crate) fn sliding_friction<S: Scalar>(friction: &Friction<S>, motion: Motion) -> Option<S> {
    match motion {
        Motion::Forward => Some(friction.fc_plus),
        Motion::Backward => Some(-friction.fc_minus),
        Motion::Stuck => None,
    }
}

/// ∫ exp(−jkωt) dt over all phases of each kind of motion, k = 0, 1 …
pub(crate) struct PhaseIntegrals {
    /// Over the forward phases, seconds.
    pub forward: Vec<Complex>,
    /// Over the backward phases, seconds.
    pub backward: Vec<Complex>,
    /// Over the phases of rest, seconds; empty if there is none.
    pub stuck: Vec<Complex>,
}

impl PhaseIntegrals {
    /// For harmonics 0 … `highest`.
    pub fn new(orbit: &SwitchingTimes, highest: usize) -> Self {
        let zero = || vec![Complex::ZERO; highest + 1];
        let stuck = if orbit.sticks() { zero() } else { Vec::new() };
        let mut these = Self { forward: zero(), backward: zero(), stuck };
        for i in 0..orbit.phases.len() {
            let (start, end, motion) = orbit.span(i);
            let sums = match motion {
                Motion::Forward => &mut these.forward,
                Motion::Backward => &mut these.backward,
                Motion::Stuck => &mut these.stuck,
            };
            sums[0] += end - start;
        }
        if !orbit.switches() {
            return these; // the integral over a whole period is 0 for k > 0
        }
        // Each time begins one phase and ends another.
        let instant = |i: usize| {
            let [begins, ends] = [i, orbit.before(i)].map(|i| orbit.phases[i].motion);
            let share = |motion| f64::from(begins == motion) - f64::from(ends == motion);
            (orbit.phases[i].start_s, [share(Motion::Forward), share(Motion::Backward)])
        };
        let instants: Vec<(f64, [f64; 2])> = (0..orbit.phases.len()).map(instant).collect();
        let omega = std::f64::consts::TAU / orbit.period_s;
        let sums = turns::sums(&instants, orbit.period_s, highest);
        for (k, [forward, backward]) in sums.into_iter().enumerate().skip(1) {
            let by_rate = Complex::new(0.0, -1.0 / (k as f64 * omega));
            these.forward[k] = forward * by_rate;
            these.backward[k] = backward * by_rate;
            // Together they are the integral over a whole period.
            if let Some(stuck) = these.stuck.get_mut(k) {
                *stuck = -(these.forward[k] + these.backward[k]);
            }
        }
        these
    }
}

/// ∫ Re(Σ Tₗ·exp(jlωt))·exp(−jkωt) dt over the phases of rest, k = 0 … `highest`, from the integrals
/// over these phases, which are computed where not enough of them are `known`.
pub(crate) fn held_lines(
    orbit: &SwitchingTimes,
    known: &PhaseIntegrals,
    lines: &[Complex],
    highest: usize,
) -> Vec<Complex> {
    let mut held = vec![Complex::new(0.0, 0.0); highest + 1];
    if !orbit.sticks() {
        return held;
    }
    let needed = highest + lines.len();
    let more = (known.stuck.len() < needed).then(|| PhaseIntegrals::new(orbit, needed));
    let stuck = &more.as_ref().unwrap_or(known).stuck;
    for (l, line) in lines.iter().enumerate().filter(|(_, line)| line.norm_sqr() > 0.0) {
        for (k, sum) in held.iter_mut().enumerate() {
            let below = if k >= l { stuck[k - l] } else { stuck[l - k].conj() };
            *sum += 0.5 * (line * below + line.conj() * stuck[k + l]);
        }
    }
    held
}
