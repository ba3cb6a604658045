//! Which parameter of a drawn effect is varied to reach a given excess.

use super::effect_scaling::Scales;
use crate::machines::simulator::Effect;

/// How an effect is made larger or smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sizing {
    /// By its size, as listed in the module `effect_scaling`. Its other properties, such as a
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
    /// The effect, `factor` times as large; `None` if that exceeds the largest realistic value.
    pub(super) fn times(self, scales: &Scales, effect: &Effect, factor: f64) -> Option<Effect> {
        match self {
            Self::Amount => scales.times(effect, factor),
            Self::Character => by_character(scales, effect, factor),
        }
    }
}

fn by_character(scales: &Scales, effect: &Effect, factor: f64) -> Option<Effect> {
    let softer = |fraction: f64, stiffness: f64, damping: f64| {
        let resonance =
            (scales.constant * stiffness / (factor * fraction * (1.0 - fraction))).sqrt();
        (resonance >= 0.5 * scales.a).then(|| (stiffness / factor, damping / factor.sqrt()))
    };
    Some(match *effect {
        Effect::Stribeck { fs_over_fc, stribeck_velocity } => {
            let stribeck_velocity = factor * stribeck_velocity;
            (stribeck_velocity <= scales.velocity())
                .then_some(Effect::Stribeck { fs_over_fc, stribeck_velocity })?
        }
        Effect::Backlash { load_inertia_fraction, stiffness, damping, gap } => {
            let (stiffness, damping) = softer(load_inertia_fraction, stiffness, damping)?;
            Effect::Backlash { load_inertia_fraction, stiffness, damping, gap }
        }
        Effect::FlexibleMode { load_inertia_fraction, stiffness, damping } => {
            let (stiffness, damping) = softer(load_inertia_fraction, stiffness, damping)?;
            Effect::FlexibleMode { load_inertia_fraction, stiffness, damping }
        }
        _ => scales.times(effect, factor)?,
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::machines::draw::draw;
    use crate::machines::effect_draws::{IDS, draw_effect};

    #[test]
    fn sizing_by_character_keeps_the_effect_at_factor_one_and_has_an_upper_limit() {
        for seed in 0..20 {
            let machine = draw((seed % 3) as u8, seed);
            let scales = Scales::of(&machine);
            for id in IDS {
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
        let softer = Sizing::Character.times(&Scales::of(&machine), &effect, 2.0).unwrap();
        let of = |effect: &Effect| match *effect {
            Effect::Backlash { load_inertia_fraction, stiffness, damping, gap } => {
                (load_inertia_fraction, stiffness, damping / stiffness.sqrt(), gap)
            }
            _ => panic!("another effect"),
        };
        let (found, expected) = (of(&softer), of(&effect));
        assert_eq!((found.0, found.3), (expected.0, expected.3));
        assert_eq!(found.1, 0.5 * expected.1);
        assert!((found.2 / expected.2 - 1.0).abs() < 1e-12);
    }
}
