//! Method `pso-ann`: like `abc-ann`, with particle swarm optimisation in place of the colony.
//!
//! ```text
//!   vⱼ ← χ (vⱼ + φ₁ r₁ (pⱼ − xⱼ) + φ₂ r₂ (gⱼ − xⱼ)),   x ← x + v,   r uniform in [0, 1] for each j
//! ```
//!
//! with p the best point of the particle, g that of the swarm, φ₁ = φ₂ = 2.05 and the constriction
//! χ = 2/|2 − φ − √(φ² − 4φ)|, φ = φ₁ + φ₂: M. Clerc and J. Kennedy, IEEE Trans. Evolutionary
//! Computation 6 (2002) 58, doi:10.1109/4235.985692. A particle that would leave the cube stops at
//! its face, and that component of its velocity becomes 0. Particles start at rest, so that the
//! neighbourhood of the proposals is searched first.

use std::convert::Infallible;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::optimiser::{Optimiser, Search, Stop};
use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: true, network: true, search: Some(&ParticleSwarm), refinement: true };

/// Number of particles: 1010 evaluations make fifty rounds, as many as the paper's colony has
/// cycles.
const PARTICLES: usize = 20;

/// φ₁ and φ₂.
const ATTRACTION: f64 = 2.05;

struct ParticleSwarm;

struct Particle {
    position: Vec<f64>,
    velocity: Vec<f64>,
    best: Vec<f64>,
    best_cost: f64,
}

impl Optimiser for ParticleSwarm {
    fn stage(&self) -> &'static str {
        "swarm"
    }

    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop> {
        let positions = search.population(PARTICLES, rng);
        let costs = search.evaluate(&positions)?;
        let mut swarm: Vec<Particle> = positions
            .into_iter()
            .zip(&costs)
            .map(|(position, cost)| Particle {
                velocity: vec![0.0; position.len()],
                best: position.clone(),
                position,
                best_cost: *cost,
            })
            .collect();
        search.report(Some(&costs))?;
        loop {
            let leader = swarm.iter().min_by(|a, b| a.best_cost.total_cmp(&b.best_cost));
            let leader = leader.map(|particle| particle.best.clone()).unwrap_or_default();
            swarm.iter_mut().for_each(|particle| particle.fly(&leader, rng));
            let positions: Vec<Vec<f64>> = swarm.iter().map(|p| p.position.clone()).collect();
            let costs = search.evaluate(&positions)?;
            for (particle, cost) in swarm.iter_mut().zip(&costs) {
                if *cost < particle.best_cost {
                    particle.best_cost = *cost;
                    particle.best.clone_from(&particle.position);
                }
            }
            search.report(Some(&costs))?;
        }
    }
}

impl Particle {
    fn fly(&mut self, leader: &[f64], rng: &mut ChaCha8Rng) {
        let sum = 2.0 * ATTRACTION;
        let constriction = 2.0 / (2.0 - sum - (sum * sum - 4.0 * sum).sqrt()).abs();
        for (j, x) in self.position.iter_mut().enumerate() {
            let own = ATTRACTION * rng.random_range(0.0..=1.0) * (self.best[j] - *x);
            let shared = ATTRACTION * rng.random_range(0.0..=1.0) * (leader[j] - *x);
            let velocity = constriction * (self.velocity[j] + own + shared);
            let wanted = *x + velocity;
            *x = wanted.clamp(0.0, 1.0);
            self.velocity[j] = if *x == wanted { velocity } else { 0.0 };
        }
    }
}
