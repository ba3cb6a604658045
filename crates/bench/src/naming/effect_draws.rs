//! Effects drawn at random, in proportion to the machine they hide in.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use servoscope_core::effects::{ALL, Draws, MachineScales, find};

use crate::machines::draw::{Draw, log_uniform};
use crate::machines::simulator::Effect;

/// Ids of the effects that a diagnosis may name.
pub fn ids() -> Vec<&'static str> {
    ALL.iter().map(|effect| effect.id()).collect()
}

/// Scales of a machine and its design.
pub(crate) fn scales(draw: &Draw) -> MachineScales {
    let friction = draw.plant.friction;
    let magnitudes = || draw.design.iter().map(|(magnitude, _)| *magnitude);
    MachineScales {
        viscous_rate: draw.plant.viscous_rate_rad_s,
        constant: draw.plant.constant,
        coulomb: [friction.fc_plus, friction.fc_minus],
        lowest: magnitudes().fold(f64::INFINITY, f64::min),
        highest: magnitudes().fold(0.0, f64::max),
        fastest_rad_s: draw.design.iter().map(|(_, omega)| *omega).fold(0.0, f64::max),
    }
}

/// Draws an effect of a size that a lab would meet in the machine and design of `draw`.
///
/// # Panics
/// If no effect has this id, or the design is empty.
pub fn draw_effect(id: &str, draw: &Draw, rng: &mut ChaCha8Rng) -> Effect {
    assert!(!draw.design.is_empty(), "an empty design");
    let effect = find(id).unwrap_or_else(|| panic!("no effect is called `{id}`"));
    Effect::of(id, &(effect.descriptor().draw.draw)(&scales(draw), &mut Random(rng)))
}

/// Whether one of two effects or outsiders contains or replaces the other, so that both together
/// make no sense.
pub(super) fn exclude_each_other(left: &str, right: &str) -> bool {
    const PAIRS: [[&str; 2]; 6] = [
        ["backlash", "flexible_mode"],
        ["spring", "hardening_spring"],
        ["presliding", "static_friction"],
        ["input_quantisation", "actuator_dead_zone"],
        ["input_quantisation", "gain_asymmetry"],
        ["input_quantisation", "actuator_saturation"],
    ];
    left == right || PAIRS.contains(&[left, right]) || PAIRS.contains(&[right, left])
}

/// Two different effects, unless they exclude each other.
pub(super) fn two(rng: &mut ChaCha8Rng) -> Option<Vec<&'static str>> {
    let ids: Vec<&'static str> = ids().sample(rng, 2).copied().collect();
    (!exclude_each_other(ids[0], ids[1])).then_some(ids)
}

/// Draws from a stream of random numbers.
pub(super) struct Random<'a>(pub &'a mut ChaCha8Rng);

impl Draws for Random<'_> {
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        log_uniform(low, high, self.0)
    }

    fn signed(&mut self, low: f64, high: f64) -> f64 {
        let size = self.0.random_range(low..=high);
        if self.0.random() { size } else { -size }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::machines::draw::draw;

    #[test]
    fn every_effect_is_drawn_with_parameters_it_can_have() {
        for id in ids() {
            for seed in 0..50 {
                let rng = &mut ChaCha8Rng::seed_from_u64(seed);
                let effect = draw_effect(id, &draw(0, seed), rng);
                assert_eq!(effect.id(), id);
                effect.check().unwrap();
                let again = &mut ChaCha8Rng::seed_from_u64(seed);
                assert_eq!(draw_effect(id, &draw(0, seed), again), effect);
            }
        }
    }

    #[test]
    fn both_simulators_know_the_parameters_of_an_effect_by_the_same_names() {
        for effect in ALL {
            let drawn = draw_effect(effect.id(), &draw(0, 1), &mut ChaCha8Rng::seed_from_u64(1));
            let names: Vec<&str> = drawn.parameters().iter().map(|(name, _)| *name).collect();
            let known: Vec<&str> = effect.parameters().iter().map(|own| own.name).collect();
            assert_eq!(names, known, "{}", effect.id());
        }
    }
}
