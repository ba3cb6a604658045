//! The answer: the experiments in their order, and what they and the sweeps show.

use indexmap::IndexMap;
use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::{EffectSize, Plan, PlannedEffect, PlannedExperiment, PlannedSweep};
use crate::effects::{ALL, Effect};
use crate::measurement::per_cent;

use super::criterion::{Left, SURE, left, mean};
use super::design::{Design, Point};
use super::information::{SIZES, Scenario, Share, VARIANTS};
use super::order;
use super::setting::{HARMONICS, Setting};
use super::sizes::{factor_from, size};
use super::sweep::Sweep;

/// Points and their repeats, in order.
type Ordered = Vec<(usize, usize)>;

/// What an answer is made of.
pub(super) struct Report<'a> {
    pub setting: &'a Setting,
    pub points: &'a [Point],
    pub scenarios: &'a [Scenario],
    pub imitators: &'a [Vec<usize>],
    pub allowed: &'a [bool],
}

/// What is left of every effect, by axis.
struct Shown(Vec<Vec<[Left; VARIANTS]>>);

impl Shown {
    /// The mean over axes and variants of the score of an effect.
    fn score_of(&self, effect: usize) -> f64 {
        let variants = self.0.iter().flat_map(|axis| &axis[effect]);
        variants.map(Left::score).sum::<f64>() / (self.0.len() * VARIANTS) as f64
    }

    fn score(&self) -> f64 {
        self.0.iter().map(|axis| mean(axis, Left::score)).sum::<f64>() / self.0.len() as f64
    }

    /// The mean over axes and forms of the probability that an effect of the whole size is named.
    fn probability(&self, effect: usize) -> f64 {
        let whole = |axis: &[Left; VARIANTS]| {
            axis.iter().step_by(SIZES).map(|left| left.probability(1.0)).sum::<f64>()
        };
        let sum: f64 = self.0.iter().map(|axis| whole(&axis[effect])).sum();
        sum / (self.0.len() * VARIANTS / SIZES) as f64
    }

    fn nameable(&self) -> usize {
        (0..ALL.len()).filter(|effect| self.probability(*effect) >= SURE).count()
    }
}

impl Report<'_> {
    /// The answer for a design.
    pub fn plan(&self, design: &Design, sweeps: &[Sweep], rng: &mut ChaCha8Rng) -> Plan {
        let measured: Vec<usize> = design.measured().collect();
        let chosen: Vec<Point> = measured.iter().map(|point| self.points[*point]).collect();
        let order = order::of(&chosen, rng);
        let ordered: Ordered =
            order.iter().map(|i| (measured[*i], design.0[measured[*i]])).collect();
        let shown = self.shown(&ordered);
        let mut experiments = self.experiments(&ordered);
        let serves: Vec<Option<usize>> =
            (0..ordered.len()).into_par_iter().map(|i| self.serves(&ordered, i, &shown)).collect();
        for (experiment, serves) in experiments.iter_mut().zip(serves) {
            experiment.serves = serves.map(|effect| ALL[effect].id().to_owned());
        }
        let request = self.setting.request;
        Plan {
            software_version: env!("CARGO_PKG_VERSION").to_owned(),
            request,
            duration_s: duration_s(&experiments),
            harmonics: HARMONICS,
            score: shown.score(),
            nameable: shown.nameable(),
            effects: self.effects(&ordered, &shown),
            sweeps: sweeps.iter().map(|sweep| self.sweep(sweep)).collect(),
            notes: self.notes(),
            experiments,
        }
    }

    fn experiments(&self, ordered: &Ordered) -> Vec<PlannedExperiment> {
        let numbered = ordered.iter().enumerate();
        numbered
            .map(|(run, (point, repeats))| self.points[*point].experiment(run, *repeats))
            .collect()
    }

    /// The products of experiments in their order, for one axis.
    fn sum(&self, scenario: &Scenario, ordered: &Ordered) -> DMatrix<f64> {
        let last = ordered.len().saturating_sub(1).max(1) as f64;
        let mut sum = scenario.nothing();
        for (run, (point, repeats)) in ordered.iter().enumerate() {
            scenario.add(&mut sum, *point, *repeats as f64, Share::at(run as f64 / last));
        }
        sum
    }

    fn shown(&self, ordered: &Ordered) -> Shown {
        let of = |scenario| left(scenario, &self.sum(scenario, ordered), self.imitators);
        Shown(self.scenarios.iter().map(of).collect())
    }

    /// The effect whose score falls most without one of the experiments.
    fn serves(&self, ordered: &Ordered, index: usize, shown: &Shown) -> Option<usize> {
        let mut fewer = ordered.clone();
        fewer.remove(index);
        let without = self.shown(&fewer);
        let fall = |effect| shown.score_of(effect) - without.score_of(effect);
        let falls = (0..ALL.len()).map(|effect| (effect, fall(effect)));
        falls.filter(|(_, fall)| *fall > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(e, _)| e)
    }

    fn effects(&self, ordered: &Ordered, shown: &Shown) -> Vec<PlannedEffect> {
        // Sizes are those in the axis as it was given.
        let [scenario, ..] = self.scenarios else { return Vec::new() };
        let sum = self.sum(scenario, ordered);
        let response: f64 = ordered
            .iter()
            .map(|(point, repeats)| *repeats as f64 * scenario.response(*point))
            .sum();
        let scales = self.setting.scales(&self.setting.plant);
        let effect = |(index, effect): (usize, &&'static dyn Effect)| {
            let typical = &scenario.variants[index][0];
            let column = scenario.base + VARIANTS * index;
            let change = (sum[(column, column)] / response.max(f64::MIN_POSITIVE)).sqrt();
            let sized = |factor: f64| size(*effect, &scales, typical, factor, change);
            let typical_form = &shown.0[0][index][..SIZES];
            let from = |of: fn(&Left) -> f64| {
                sized(factor_from(std::array::from_fn(|size| of(&typical_form[size]))))
            };
            let left = typical_form[0];
            PlannedEffect {
                effect: effect.id().to_owned(),
                title: effect.descriptor().title.to_owned(),
                typical: sized(1.0).unwrap_or_else(|| EffectSize {
                    parameters: IndexMap::new(),
                    set_by: Vec::new(),
                    change,
                }),
                noticed_from: from(|left| left.excess),
                named_from: from(|left| left.beyond),
                closest_imitator: left.imitator.map(|imitator| ALL[imitator].id().to_owned()),
                probability: shown.probability(index),
                score: shown.score_of(index),
            }
        };
        ALL.iter().enumerate().map(effect).collect()
    }

    fn sweep(&self, sweep: &Sweep) -> PlannedSweep {
        let ordered: Ordered =
            sweep.order.iter().map(|point| (*point, sweep.design.0[*point])).collect();
        let shown = self.shown(&ordered);
        let experiments = self.experiments(&ordered);
        let distinct = |value: fn(&PlannedExperiment) -> f64| {
            let mut values: Vec<f64> = experiments.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        PlannedSweep {
            magnitudes: distinct(|experiment| experiment.magnitude),
            frequencies_rad_s: distinct(|experiment| experiment.omega_rad_s),
            repeats: ordered.iter().map(|(_, repeats)| *repeats).min().unwrap_or(0),
            duration_s: duration_s(&experiments),
            score: shown.score(),
            nameable: shown.nameable(),
            probabilities: ALL
                .iter()
                .enumerate()
                .map(|(index, effect)| (effect.id().to_owned(), shown.probability(index)))
                .collect(),
            experiments,
        }
    }

    fn notes(&self) -> Vec<String> {
        let request = &self.setting.request;
        let mut notes = vec![format!(
            "the plan allows for a standard deviation of {} in each parameter of the axis ({} \
             variants were drawn)",
            per_cent(request.options.uncertainty),
            self.scenarios.len() - 1
        )];
        notes.push(format!(
            "noise: a standard deviation of {:.3e} in re and im of a harmonic after one second, and {} of its \
             size in each repeat",
            self.setting.noise_std,
            per_cent(request.options.noise_share)
        ));
        notes.push(
            "the percentages are approximate: use them to compare plans, not as a promise"
                .to_owned(),
        );
        let out = self.allowed.iter().filter(|allowed| !**allowed).count();
        if out > 0 {
            notes.push(format!(
                "{out} of {} points are left out: the axis may exceed the largest velocity or \
                 travel there",
                self.allowed.len()
            ));
        }
        notes
    }
}

fn duration_s(experiments: &[PlannedExperiment]) -> f64 {
    experiments.iter().map(|experiment| experiment.duration_s).sum()
}
