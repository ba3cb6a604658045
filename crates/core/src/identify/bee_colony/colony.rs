//! The food sources of a search, and the three phases of a cycle.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Cycle, Objective, evaluate, uniform};
use crate::answers::{ColonyOptions, ColonyVariant};

/// Share of the dimensions that the global-best variant modifies: the best of 0.1 to 1 in Akay and
/// Karaboga's study of problems whose parameters interact.
const MODIFICATION_RATE: f64 = 0.5;
/// Upper end of ψ: Zhu and Kwong's best value.
const PULL_TO_BEST: f64 = 1.5;

pub(super) struct FoodSource {
    pub(super) position: Vec<f64>,
    pub(super) cost: f64,
    /// Neighbours tried without success since the source was found.
    failures: usize,
}

pub(super) struct Colony<'a, O: ?Sized> {
    objective: &'a O,
    variant: ColonyVariant,
    abandonment_limit: usize,
    pub(super) sources: Vec<FoodSource>,
    abandoned: Option<usize>,
    pub(super) scouts_sent: usize,
    pub(super) evaluations: usize,
}

impl<'a, O: Objective + ?Sized> Colony<'a, O> {
    /// Evaluates the initial sources.
    pub(super) fn settle(
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
    pub(super) fn fly(&mut self, rng: &mut ChaCha8Rng) {
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

    pub(super) fn best(&self) -> usize {
        (0..self.sources.len())
            .min_by(|&i, &j| self.sources[i].cost.total_cmp(&self.sources[j].cost))
            .unwrap_or(0)
    }

    pub(super) fn report(&self, cycle: usize) -> Cycle {
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

/// A source other than `index`, all with equal probability.
fn draw_other(count: usize, index: usize, rng: &mut ChaCha8Rng) -> usize {
    let drawn = rng.random_range(0..count - 1);
    if drawn < index { drawn } else { drawn + 1 }
}

/// A rank r of 0 (best) to count − 1, with probability ∝ count − r.
pub(super) fn draw_rank(count: usize, rng: &mut ChaCha8Rng) -> usize {
    let mut ticket = rng.random_range(0..count * (count + 1) / 2);
    let mut rank = 0;
    while ticket >= count - rank {
        ticket -= count - rank;
        rank += 1;
    }
    rank
}
