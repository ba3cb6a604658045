//! Axes as they may be, and effects of typical sizes in them.
//!
//! A plan must be good for the axis that is there, not for the rough idea of it: its criterion is the
//! mean over axes drawn around the idea (K. Chaloner, I. Verdinelli 1995, doi:10.1214/ss/1177009939).

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::effects::{DrawPlan, Draws, Effect, MachineScales, Middle};
use crate::plant::{Friction, Plant};

/// A plant whose every parameter is off by a log-normal factor.
pub(super) fn drawn(plant: &Plant, uncertainty: f64, rng: &mut ChaCha8Rng) -> Plant {
    let mut off = |value: f64| {
        let normal: f64 = StandardNormal.sample(rng);
        value * (uncertainty * normal).exp()
    };
    let (viscous_rate_rad_s, constant) = (off(plant.viscous_rate_rad_s), off(plant.constant));
    let actuator = plant.actuator.map(&mut off);
    // Friction differs little between the directions: what is uncertain is its size.
    let factor = off(1.0);
    let friction =
        Friction::coulomb(factor * plant.friction.fc_plus, factor * plant.friction.fc_minus);
    Plant { viscous_rate_rad_s, constant, actuator, friction }
}

/// Parameters of an effect in an axis of these scales: of every form, a typical one first, then drawn
/// ones, every size. A size that no axis has is replaced by the whole.
pub(super) fn variants(
    effect: &dyn Effect,
    scales: &MachineScales,
    forms: usize,
    factors: &[f64],
    rng: &mut ChaCha8Rng,
) -> Vec<Vec<f64>> {
    let DrawPlan { draw, scaled, .. } = effect.descriptor().draw;
    let drawn: Vec<Vec<f64>> = (1..forms).map(|_| draw(scales, &mut Random(rng))).collect();
    let forms = std::iter::once(draw(scales, &mut Middle)).chain(drawn);
    let sized = |form: &[f64], factor: f64| scaled(scales, form, factor);
    forms
        .flat_map(|form| {
            let sizes = factors.iter().map(|factor| sized(&form, *factor));
            sizes.map(|size| size.unwrap_or_else(|| form.clone())).collect::<Vec<_>>()
        })
        .collect()
}

/// Draws from a stream of random numbers.
struct Random<'a>(&'a mut ChaCha8Rng);

impl Draws for Random<'_> {
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.0.random_range(0.0..=1.0))
    }

    fn signed(&mut self, low: f64, high: f64) -> f64 {
        let size = self.0.random_range(low..=high);
        if self.0.random() { size } else { -size }
    }
}
