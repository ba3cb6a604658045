//! Which parameter of a drawn effect is varied to reach a given excess.

use servoscope_core::effects::{MachineScales, find};

use super::outsiders;
use crate::machines::simulator::Effect;

/// How an effect is made larger or smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sizing {
    /// By its size, as its `DrawPlan` scales it. Its other properties, such as a
    /// resonance frequency, stay as drawn.
    #[default]
    Amount,
    /// By another property, for effects that have one:
    ///
    /// | effect | varied | limit |
    /// | --- | --- | --- |
    /// | `stribeck` | vs | V |
    /// | `backlash`, `flexible_mode` | 1/k and 1/c² (same damping ratio) | resonance at a/2 |
    ///
    /// All others as with [`Sizing::Amount`].
    Character,
}

impl Sizing {
    /// The effect or outsider `factor` times as large; `None` where no machine would have that.
    pub(super) fn times(
        self,
        scales: &MachineScales,
        effect: &Effect,
        factor: f64,
    ) -> Option<Effect> {
        let id = effect.id();
        let scaling = match find(id).map(|effect| &effect.descriptor().draw) {
            Some(plan) => match self {
                Self::Amount => plan.scaled,
                Self::Character => plan.by_character.unwrap_or(plan.scaled),
            },
            None => outsiders::scaling(id)?,
        };
        Some(Effect::of(id, &scaling(scales, effect.values(), factor)?))
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::super::effect_draws::{draw_effect, ids, scales};
    use super::super::outsiders::draw_outsider;
    use super::*;
    use crate::machines::draw::draw;

    #[test]
    fn sizing_by_character_keeps_the_effect_at_factor_one_and_has_an_upper_limit() {
        for seed in 0..20 {
            let machine = draw((seed % 3) as u8, seed);
            let scales = scales(&machine);
            for id in ids() {
                let effect = draw_effect(id, &machine, &mut ChaCha8Rng::seed_from_u64(seed));
                let times = |factor: f64| Sizing::Character.times(&scales, &effect, factor);
                let same = times(1.0).unwrap();
                for (found, expected) in same.parameters().iter().zip(effect.parameters()) {
                    // Rounding of a few operations.
                    assert!((found.1 - expected.1).abs() <= 1e-12 * expected.1.abs(), "{id}");
                }
                times(0.1).unwrap().check().unwrap();
                assert_eq!(times(1e5), None, "{id}");
            }
        }
    }

    #[test]
    fn a_softer_joint_keeps_its_load_its_damping_ratio_and_its_gap() {
        let machine = draw(0, 3);
        let effect = draw_effect("backlash", &machine, &mut ChaCha8Rng::seed_from_u64(3));
        let softer = Sizing::Character.times(&scales(&machine), &effect, 2.0).unwrap();
        let of = |effect: &Effect| {
            let [load, stiffness, damping, gap] = effect.values() else { panic!("another effect") };
            (*load, *stiffness, damping / stiffness.sqrt(), *gap)
        };
        let (found, expected) = (of(&softer), of(&effect));
        assert_eq!((found.0, found.3), (expected.0, expected.3));
        assert_eq!(found.1, 0.5 * expected.1);
        assert!((found.2 / expected.2 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_factor_of_one_changes_nothing_and_no_machine_has_ten_thousand_times_as_much() {
        for seed in 0..20 {
            let machine = draw((seed % 3) as u8, seed);
            let scales = scales(&machine);
            let rng = &mut ChaCha8Rng::seed_from_u64(seed);
            let mut all: Vec<Effect> =
                ids().into_iter().map(|id| draw_effect(id, &machine, rng)).collect();
            let outside = outsiders::ids().into_iter();
            all.extend(outside.map(|id| draw_outsider(id, &machine, rng)));
            for effect in all {
                let times = |factor: f64| Sizing::Amount.times(&scales, &effect, factor);
                let same = times(1.0).unwrap();
                for (found, expected) in same.values().iter().zip(effect.values()) {
                    // Rounding of a few operations.
                    assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{effect:?}");
                }
                times(0.1).unwrap().check().unwrap();
                assert_eq!(times(1e4), None, "{effect:?}");
            }
        }
    }

    #[test]
    fn a_joint_with_less_load_keeps_its_resonance_and_damping_ratio() {
        let machine = draw(0, 3);
        let effect = draw_effect("flexible_mode", &machine, &mut ChaCha8Rng::seed_from_u64(3));
        let modal = |effect: &Effect| {
            let [load, stiffness, damping] = effect.values() else { panic!("another effect") };
            let inertia = load * (1.0 - load) / machine.plant.constant;
            [stiffness / inertia, damping / inertia]
        };
        let smaller = Sizing::Amount.times(&scales(&machine), &effect, 0.2).unwrap();
        for (found, expected) in modal(&smaller).into_iter().zip(modal(&effect)) {
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
    }
}
