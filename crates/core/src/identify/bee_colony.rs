//! Artificial bee colony: a population search that needs no derivatives.
//!
//! A *food source* is a point of the unit cube \[0, 1\]ⁿ. In every cycle
//!
//! 1. each source's *employed* bee tries a neighbour of it,
//! 2. as many *onlookers* choose good sources and try a neighbour each,
//! 3. a source that has failed to improve too often is abandoned to a *scout*.
//!
//! A neighbour v of source x, with a random other source y and the best source g:
//!
//! ```text
//!   literal       vⱼ = xⱼ + φ (xⱼ − yⱼ)                   one random dimension j
//!   global best   vⱼ = xⱼ + φ (xⱼ − yⱼ) + ψ (gⱼ − xⱼ)     each j with rate 0.5, at least one
//!   φ uniform in [−1, 1], ψ uniform in [0, 1.5], drawn for each j; v clamped to the cube
//! ```
//!
//! It replaces x if it costs less. Sources: D. Karaboga and B. Basturk, J. Global Optim. 39 (2007)
//! 459, doi:10.1007/s10898-007-9149-x; the term in ψ: G. Zhu and S. Kwong, Appl. Math. Comput. 217
//! (2010) 3166, doi:10.1016/j.amc.2010.08.049; the modification rate: B. Akay and D. Karaboga,
//! Inform. Sci. 192 (2012) 120, doi:10.1016/j.ins.2010.07.015.
//!
//! Three choices differ from those papers:
//! - Onlookers choose by the *rank* of a source (the best of n with weight n, the worst with weight
//!   1). The usual fitness 1/(1 + f) is flat for f ≪ 1, and onlookers then choose at random. With
//!   ranks, scaling the cost changes nothing.
//! - All bees of a phase start from the sources as they were at its beginning, so that a phase is
//!   one parallel batch. Random numbers are drawn before the batch: the result is bit-identical at
//!   any number of threads.
//! - A scout takes the place of the abandoned source's employed bee in the next cycle. Scouts
//!   therefore cost nothing extra: a search uses exactly `food_sources · (2 · cycles + 1)`
//!   evaluations. At most one source is abandoned in a cycle, never the best one.

use std::ops::ControlFlow;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::{ColonyOptions, ColonyVariant};

/// Share of the dimensions that the global-best variant modifies: the best of 0.1 to 1 in Akay and
/// Karaboga's study of problems whose parameters interact.
const MODIFICATION_RATE: f64 = 0.5;
/// Upper end of ψ: Zhu and Kwong's best value.
const PULL_TO_BEST: f64 = 1.5;

/// A function to minimise.
pub trait Objective: Sync {
    /// Number of parameters, at least 1.
    fn dimension(&self) -> usize;

    /// Cost of a point of the unit cube; may be +∞, and NaN counts as +∞.
    ///
    /// Called from several threads at once.
    fn cost(&self, point: &[f64]) -> f64;
}

/// The state of the colony after a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Cycles done; 0 after the initial sources have been evaluated.
    pub cycle: usize,
    /// Costs evaluated so far.
    pub evaluations: usize,
    /// Least cost so far.
    pub best_cost: f64,
    /// Mean over the sources whose cost is finite; +∞ if none is.
    pub mean_cost: f64,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// All cycles are done.
    CyclesDone,
    /// The callback asked to stop.
    Cancelled,
}

/// The result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The best source, a point of the unit cube.
    pub best: Vec<f64>,
    /// Its cost; +∞ if no point had a finite cost.
    pub cost: f64,
    /// Costs evaluated.
    pub evaluations: usize,
    /// Number of sources that were abandoned to a scout.
    pub abandoned: usize,
    /// Why it ended.
    pub stop: StopReason,
}

/// Searches the unit cube for the least cost.
///
/// `initial` are the first food sources, clamped to the cube. Those beyond `colony.food_sources`
/// are ignored, and missing ones are drawn uniformly. `on_cycle` is called after the initial
/// sources (cycle 0) and after every cycle, and ends the search by breaking.
///
/// # Panics
/// If there are fewer than 2 food sources, no dimension, or an initial source of another dimension.
pub fn search<O: Objective + ?Sized>(
    objective: &O,
    initial: &[Vec<f64>],
    colony: &ColonyOptions,
    rng: &mut ChaCha8Rng,
    on_cycle: &mut dyn FnMut(&Cycle) -> ControlFlow<()>,
) -> Outcome {
    let mut state = Colony::settle(objective, initial, colony, rng);
    let mut stop = StopReason::CyclesDone;
    for cycle in 0..=colony.cycles {
        if cycle > 0 {
            state.fly(rng);
        }
        if on_cycle(&state.report(cycle)).is_break() {
            stop = StopReason::Cancelled;
            break;
        }
    }
    let best = &state.sources[state.best()];
    Outcome {
        best: best.position.clone(),
        cost: best.cost,
        evaluations: state.evaluations,
        abandoned: state.scouts_sent,
        stop,
    }
}

struct FoodSource {
    position: Vec<f64>,
    cost: f64,
    /// Neighbours tried without success since the source was found.
    failures: usize,
}

struct Colony<'a, O: ?Sized> {
    objective: &'a O,
    variant: ColonyVariant,
    abandonment_limit: usize,
    sources: Vec<FoodSource>,
    abandoned: Option<usize>,
    scouts_sent: usize,
    evaluations: usize,
}

impl<'a, O: Objective + ?Sized> Colony<'a, O> {
    /// Evaluates the initial sources.
    fn settle(
        objective: &'a O,
        initial: &[Vec<f64>],
        options: &ColonyOptions,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let dimension = objective.dimension();
        let count = options.food_sources;
        assert!(count >= 2 && dimension >= 1, "{count} food sources in {dimension} dimensions");
        let mut positions: Vec<Vec<f64>> = initial
            .iter()
            .take(count)
            .inspect(|point| assert_eq!(point.len(), dimension, "dimension of an initial source"))
            .map(|point| point.iter().map(|x| x.clamp(0.0, 1.0)).collect())
            .collect();
        positions.resize_with(count, || uniform(dimension, rng));
        let costs = evaluate(objective, &positions);
        let sources = positions
            .into_iter()
            .zip(costs)
            .map(|(position, cost)| FoodSource { position, cost, failures: 0 })
            .collect();
        Self {
            objective,
            variant: options.variant,
            abandonment_limit: options.abandonment_limit.unwrap_or(count * dimension),
            sources,
            abandoned: None,
            scouts_sent: 0,
            evaluations: count,
        }
    }

    /// One cycle.
    fn fly(&mut self, rng: &mut ChaCha8Rng) {
        self.employed_phase(rng);
        self.onlooker_phase(rng);
        self.scout_phase();
    }

    fn employed_phase(&mut self, rng: &mut ChaCha8Rng) {
        let best = self.best();
        let candidates: Vec<Vec<f64>> = (0..self.sources.len())
            .map(|index| {
                if self.abandoned == Some(index) {
                    uniform(self.objective.dimension(), rng)
                } else {
                    self.neighbour(index, best, rng)
                }
            })
            .collect();
        // The scout's point replaces the abandoned source at any cost.
        if let Some(index) = self.abandoned.take() {
            let position = candidates[index].clone();
            self.sources[index] = FoodSource { position, cost: f64::INFINITY, failures: 0 };
            self.scouts_sent += 1;
        }
        self.try_candidates((0..self.sources.len()).collect(), candidates);
    }

    fn onlooker_phase(&mut self, rng: &mut ChaCha8Rng) {
        let count = self.sources.len();
        let best = self.best();
        let mut by_cost: Vec<usize> = (0..count).collect();
        by_cost.sort_by(|&i, &j| self.sources[i].cost.total_cmp(&self.sources[j].cost));
        let chosen: Vec<usize> = (0..count).map(|_| by_cost[draw_rank(count, rng)]).collect();
        let candidates = chosen.iter().map(|&index| self.neighbour(index, best, rng)).collect();
        self.try_candidates(chosen, candidates);
    }

    fn scout_phase(&mut self) {
        let best = self.best();
        self.abandoned = (0..self.sources.len())
            .filter(|&index| index != best)
            .max_by_key(|&index| self.sources[index].failures)
            .filter(|&index| self.sources[index].failures >= self.abandonment_limit);
    }

    /// A neighbour of a source, as defined in the module documentation.
    fn neighbour(&self, index: usize, best: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let mut point = self.sources[index].position.clone();
        let other = &self.sources[draw_other(self.sources.len(), index, rng)].position;
        let always = rng.random_range(0..point.len());
        match self.variant {
            ColonyVariant::Literal => {
                let x = &mut point[always];
                *x = (*x + rng.random_range(-1.0..=1.0) * (*x - other[always])).clamp(0.0, 1.0);
            }
            ColonyVariant::GlobalBest => {
                let best = &self.sources[best].position;
                for (j, x) in point.iter_mut().enumerate() {
                    let modified = rng.random_bool(MODIFICATION_RATE) || j == always;
                    if modified {
                        let away = rng.random_range(-1.0..=1.0) * (*x - other[j]);
                        let pull = rng.random_range(0.0..=PULL_TO_BEST) * (best[j] - *x);
                        *x = (*x + away + pull).clamp(0.0, 1.0);
                    }
                }
            }
        }
        point
    }

    /// Evaluates all candidates, then lets each replace its source if it costs less.
    fn try_candidates(&mut self, chosen: Vec<usize>, candidates: Vec<Vec<f64>>) {
        let costs = evaluate(self.objective, &candidates);
        self.evaluations += costs.len();
        for ((index, position), cost) in chosen.into_iter().zip(candidates).zip(costs) {
            let source = &mut self.sources[index];
            if cost < source.cost {
                *source = FoodSource { position, cost, failures: 0 };
            } else {
                source.failures += 1;
            }
        }
    }

    fn best(&self) -> usize {
        (0..self.sources.len())
            .min_by(|&i, &j| self.sources[i].cost.total_cmp(&self.sources[j].cost))
            .unwrap_or(0)
    }

    fn report(&self, cycle: usize) -> Cycle {
        let finite = || self.sources.iter().map(|s| s.cost).filter(|cost| cost.is_finite());
        let count = finite().count();
        let mean_cost =
            if count == 0 { f64::INFINITY } else { finite().sum::<f64>() / count as f64 };
        Cycle {
            cycle,
            evaluations: self.evaluations,
            best_cost: self.sources[self.best()].cost,
            mean_cost,
        }
    }
}

/// Costs of points, evaluated in parallel; NaN becomes +∞.
pub(super) fn evaluate<O: Objective + ?Sized>(objective: &O, points: &[Vec<f64>]) -> Vec<f64> {
    let cost = |point: &Vec<f64>| match objective.cost(point) {
        cost if cost.is_nan() => f64::INFINITY,
        cost => cost,
    };
    points.par_iter().map(cost).collect()
}

/// A uniform draw from the cube.
pub(super) fn uniform(dimension: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    (0..dimension).map(|_| rng.random_range(0.0..=1.0)).collect()
}

/// A source other than `index`, all with equal probability.
fn draw_other(count: usize, index: usize, rng: &mut ChaCha8Rng) -> usize {
    let drawn = rng.random_range(0..count - 1);
    if drawn < index { drawn } else { drawn + 1 }
}

/// A rank r of 0 (best) to count − 1, with probability ∝ count − r.
fn draw_rank(count: usize, rng: &mut ChaCha8Rng) -> usize {
    let mut ticket = rng.random_range(0..count * (count + 1) / 2);
    let mut rank = 0;
    while ticket >= count - rank {
        ticket -= count - rank;
        rank += 1;
    }
    rank
}

#[cfg(test)]
mod tests;
