//! The effects of a machine as real ones are: one or two that dominate, and several small ones.

use std::ops::RangeInclusive;

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::dominance::Dominance;
use super::effect_draws::{draw_effect, exclude_each_other, ids, scales};
use super::excess::COARSE;
use super::instrument::Instrument;
use super::outsiders;
use super::sizing::Sizing;
use crate::machines::draw::{Draw, log_uniform};
use crate::machines::simulator::{Effect, Settings};

/// χ² per degree of freedom that the dominant effects leave.
pub(super) const CHI2_PER_DOF: [f64; 2] = [1.5, 30.0];
/// Least share of the base model's excess that the dominant effects make.
const LEAST_SHARE: f64 = 0.9;
/// Least share that each of two dominant effects makes beside the other.
const LEAST_SHARE_OF_EACH: f64 = 0.2;
/// Number of small effects.
const SMALL: RangeInclusive<usize> = 3..=6;
/// Excess of the dominant effects, as a multiple of what they leave.
const DOMINANT_RATIO: [f64; 2] = [12.0, 60.0];
/// Share of the first of two dominant effects in the excess of both.
const SHARE_OF_FIRST: [f64; 2] = [0.35, 0.65];
/// Ratio of the excesses of two small effects, at most.
const SMALL_RATIO: f64 = 10.0;
/// Largest change of the size of all small effects together.
const LARGEST_CHANGE: f64 = 4.0;

/// What the effects of a machine are drawn for.
pub(super) struct Mixing<'a, S: Fn(Effect, f64) -> Option<Effect>> {
    /// The machine, without effects.
    pub machine: &'a Draw,
    /// How it is measured.
    pub instrument: &'a Instrument,
    /// Scales an effect, alone in the machine, to an excess of the base model.
    pub sized: S,
    /// χ² per degree of freedom that the dominant effects shall leave.
    pub chi2_per_dof: f64,
}

impl<S: Fn(Effect, f64) -> Option<Effect>> Mixing<'_, S> {
    /// Draws the effects, the dominant ones of these ids first. `None` if no size of one reaches
    /// its target.
    ///
    /// Every effect is sized alone. Then all small ones together are made larger or smaller, so that
    /// the dominant ones leave about what they shall.
    pub(super) fn draw(&self, dominant: &[&str], rng: &mut ChaCha8Rng) -> Option<Vec<Effect>> {
        let data = self.machine.design.len() * (2 * self.machine.harmonics + 1);
        let left = (self.chi2_per_dof - 1.0) * data as f64;
        let mut effects = self.dominant(dominant, left, rng)?;
        let small = self.small(&effects, left, rng)?;
        effects.extend(self.brought(&effects, small, left)?);
        Some(effects)
    }

    fn dominant(&self, ids: &[&str], left: f64, rng: &mut ChaCha8Rng) -> Option<Vec<Effect>> {
        let [least, most] = DOMINANT_RATIO;
        let whole = left * log_uniform(least, most, rng);
        let first = rng.random_range(SHARE_OF_FIRST[0]..=SHARE_OF_FIRST[1]);
        let shares = if ids.len() == 1 { vec![1.0] } else { vec![first, 1.0 - first] };
        let sized = |(id, share): (&&str, f64)| {
            (self.sized)(draw_effect(id, self.machine, rng), share * whole)
        };
        ids.iter().zip(shares).map(sized).collect()
    }

    /// Small effects of the library and outsiders whose excesses have the sum `left`.
    fn small(&self, dominant: &[Effect], left: f64, rng: &mut ChaCha8Rng) -> Option<Vec<Effect>> {
        let count = rng.random_range(SMALL);
        let weights: Vec<f64> = (0..count).map(|_| log_uniform(1.0, SMALL_RATIO, rng)).collect();
        let sum: f64 = weights.iter().sum();
        let mut pool = [ids(), outsiders::ids()].concat();
        pool.shuffle(rng);
        let mut taken: Vec<&str> = dominant.iter().map(Effect::id).collect();
        let mut small = Vec::new();
        for id in pool {
            let Some(weight) = weights.get(small.len()) else { break };
            if taken.iter().any(|other| exclude_each_other(id, other)) {
                continue;
            }
            let effect = match outsiders::ids().contains(&id) {
                true => outsiders::draw_outsider(id, self.machine, rng),
                false => draw_effect(id, self.machine, rng),
            };
            if let Some(effect) = (self.sized)(effect, left * weight / sum) {
                small.push(effect);
                taken.push(id);
            }
        }
        (small.len() == count).then_some(small)
    }

    /// The small effects, all larger or smaller by one factor, so that the dominant ones leave
    /// about `left`: the excess grows with the square of the size.
    fn brought(&self, dominant: &[Effect], small: Vec<Effect>, left: f64) -> Option<Vec<Effect>> {
        let effects = [dominant, &small].concat();
        let machine = Draw { effects, ..self.machine.clone() };
        let found = dominance(&machine, dominant.len(), self.instrument, &COARSE)?.left;
        let factor = (left / found).sqrt().clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
        let scales = scales(self.machine);
        // One that cannot be larger stays as it is.
        let brought = |effect| Sizing::Amount.times(&scales, &effect, factor).unwrap_or(effect);
        Some(small.into_iter().map(brought).collect())
    }
}

/// The dominance of the first effects of a machine, this many; `None` if it cannot be fitted, or an
/// experiment has no response.
pub(super) fn dominance(
    machine: &Draw,
    dominant: usize,
    instrument: &Instrument,
    settings: &Settings,
) -> Option<Dominance> {
    let without_small = Draw { effects: machine.effects[..dominant].to_vec(), ..machine.clone() };
    let whole = instrument.responses(machine, settings).ok()?;
    let law = instrument.law(&whole).ok()?;
    let without_small = instrument.responses(&without_small, settings).ok()?;
    let ids: Vec<&str> = machine.effects[..dominant].iter().map(Effect::id).collect();
    let order = machine.plant.actuator.order();
    Dominance::of(&whole.stating(&law).ok()?, &without_small.stating(&law).ok()?, &ids, order).ok()
}

impl Dominance {
    /// Whether the machine is one that was wanted: the dominant effects make nearly all of the
    /// excess, each of them a good part of it, and leave as much as they may.
    pub(super) fn is_wanted(&self) -> bool {
        let [least, most] = CHI2_PER_DOF;
        let is_balanced = self.alone.len() == 1 || self.least_share() >= LEAST_SHARE_OF_EACH;
        (least..=most).contains(&self.chi2_per_dof) && self.share() >= LEAST_SHARE && is_balanced
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::machines::draw::draw;

    #[test]
    fn small_effects_are_three_to_six_that_go_together_with_each_other_and_the_dominant_one() {
        let machine = draw(0, 1);
        let case = "machine-60-spring-o0-0".parse().unwrap();
        let mut outsiders_among = 0;
        for seed in 0..100 {
            let rng = &mut ChaCha8Rng::seed_from_u64(seed);
            let instrument = &Instrument::of(&case, rng);
            let ids = ids();
            let dominant = draw_effect(ids[seed as usize % ids.len()], &machine, rng);
            let asked = std::cell::RefCell::new(Vec::new());
            let sized = |effect: Effect, target: f64| {
                asked.borrow_mut().push(target);
                Some(effect)
            };
            let mixing = Mixing { machine: &machine, instrument, sized, chi2_per_dof: 2.0 };
            let small = mixing.small(&[dominant], 700.0, rng).unwrap();
            assert!(SMALL.contains(&small.len()), "{}", small.len());
            let all = [&[dominant][..], &small].concat();
            for (place, effect) in all.iter().enumerate() {
                for other in &all[..place] {
                    assert!(!exclude_each_other(effect.id(), other.id()), "{effect:?} {other:?}");
                }
            }
            // Rounding of six numbers.
            assert!((asked.borrow().iter().sum::<f64>() / 700.0 - 1.0).abs() < 1e-12);
            let outside = |effect: &&Effect| outsiders::ids().contains(&effect.id());
            outsiders_among += small.iter().filter(outside).count();
        }
        // Of 25 there are 8 outsiders, so 4.5 a machine have 1.4; the standard deviation of the
        // sum over 100 machines is below 11, of which this is more than three.
        assert!((100..190).contains(&outsiders_among), "{outsiders_among}");
    }

    #[test]
    fn a_small_effect_that_cannot_be_sized_is_replaced_by_another_one() {
        let machine = draw(0, 1);
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let instrument = &Instrument::of(&"machine-60-spring-o0-0".parse().unwrap(), rng);
        let spring = draw_effect("spring", &machine, rng);
        let sized = |effect: Effect, _: f64| effect.id().len().is_multiple_of(2).then_some(effect);
        let mixing = Mixing { machine: &machine, instrument, sized, chi2_per_dof: 2.0 };
        let small = mixing.small(&[spring], 700.0, rng).unwrap();
        assert!(
            SMALL.contains(&small.len())
                && small.iter().all(|one| one.id().len().is_multiple_of(2))
        );
        let sized = |_: Effect, _: f64| None;
        let mixing = Mixing { machine: &machine, instrument, sized, chi2_per_dof: 2.0 };
        assert_eq!(mixing.small(&[spring], 700.0, rng), None);
    }

    #[test]
    fn a_machine_is_wanted_where_its_dominant_effects_make_most_and_leave_enough() {
        let of_one =
            Dominance { base: 10_000.0, alone: vec![800.0], left: 800.0, chi2_per_dof: 2.1 };
        assert!(of_one.is_wanted());
        assert!(!Dominance { base: 7_900.0, ..of_one.clone() }.is_wanted());
        assert!(!Dominance { chi2_per_dof: 1.4, ..of_one.clone() }.is_wanted());
        assert!(!Dominance { chi2_per_dof: 31.0, ..of_one.clone() }.is_wanted());
        let of_two = |alone: [f64; 2]| Dominance { alone: alone.into(), ..of_one.clone() };
        assert!(of_two([2_900.0, 7_000.0]).is_wanted());
        assert!(!of_two([2_700.0, 7_000.0]).is_wanted());
    }
}
