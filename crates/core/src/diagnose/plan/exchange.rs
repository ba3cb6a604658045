//! Chooses the experiments.
//!
//! Points are added one at a time, each time what gains most of the criterion per second, until the budget
//! is spent. Repeats of points that are there already count from the dozenth point on: they need no
//! settling. Then a point is taken out, the time it frees is filled again in the same way, and what comes
//! out is kept if it is better: an exchange (V. V. Fedorov 1972, Theory of Optimal Experiments) with
//! excursions of more than one point (T. J. Mitchell 1974, doi:10.1080/00401706.1974.10489175).

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::observer::Observer;

use super::criterion::{Left, left, mean};
use super::design::{Design, Point};
use super::information::{Scenario, Share};

/// Most exchanges.
const MOST_EXCHANGES: usize = 8;
/// How many of the least useful points are tried to be exchanged before it ends.
const TRIED: usize = 2;

/// Fewest points before any is repeated more often than it must: what a diagnosis names must show in points
/// that no fit has seen, too.
const FEWEST_POINTS: usize = 12;

/// Every how many-th step all points are tried; in between, so many of those that gained most then.
const ALL_TRIED_EVERY: usize = 6;
const PROMISING: usize = 16;

/// The choice of a design for some axes.
pub(super) struct Choice<'a> {
    /// Axes as they may be.
    pub scenarios: &'a [Scenario],
    /// The grid.
    pub points: &'a [Point],
    /// Which of its points are within the limits.
    pub allowed: &'a [bool],
    /// Which effects may imitate which.
    pub imitators: &'a [Vec<usize>],
    /// Time for all experiments, s.
    pub budget_s: f64,
    /// Stops the choice.
    pub observer: &'a dyn Observer,
}

/// A design with the products of its columns, by scenario.
#[derive(Clone)]
struct State {
    design: Design,
    sums: Vec<DMatrix<f64>>,
    score: f64,
}

impl Choice<'_> {
    /// The best design that is found, from nothing and from each of some other designs.
    pub fn best(&self, others: &[Design]) -> Design {
        let nothing = Design::none(self.points);
        let starts = std::iter::once(&nothing).chain(others);
        let filled: Vec<State> = starts.map(|start| self.filled(self.state(start))).collect();
        let best = filled.into_iter().reduce(|a, b| if b.score > a.score { b } else { a });
        best.map_or(nothing, |best| self.exchanged(best).design)
    }

    fn state(&self, design: &Design) -> State {
        let sums: Vec<_> = self.scenarios.iter().map(|scenario| scenario.sum(design)).collect();
        let score = self.judge(&sums);
        State { design: design.clone(), sums, score }
    }

    fn judge(&self, sums: &[DMatrix<f64>]) -> f64 {
        let of = |(scenario, sum): (&Scenario, &DMatrix<f64>)| {
            mean(&left(scenario, sum, self.imitators), Left::score)
        };
        self.scenarios.iter().zip(sums).map(of).sum::<f64>() / self.scenarios.len() as f64
    }

    /// The criterion after a point has so many repeats instead.
    fn with(&self, state: &State, point: usize, repeats: usize) -> State {
        let difference = repeats as f64 - state.design.0[point] as f64;
        let mut changed = state.clone();
        changed.design.0[point] = repeats;
        for (scenario, sum) in self.scenarios.iter().zip(&mut changed.sums) {
            scenario.add(sum, point, difference, Share::ANYWHERE);
        }
        changed.score = self.judge(&changed.sums);
        changed
    }

    /// Adds what gains most per second until nothing fits.
    fn filled(&self, mut state: State) -> State {
        // What each point gained per second when it was last tried.
        let mut last = vec![f64::INFINITY; self.points.len()];
        for step in 0.. {
            let left_s = self.budget_s - state.design.duration_s(self.points);
            let fitting: Vec<(usize, usize, f64)> = (0..self.points.len())
                .filter(|point| self.allowed[*point])
                .map(|point| {
                    let fitting = (left_s / self.points[point].repeat_s()) as usize;
                    let repeats = state.design.more(point, fitting);
                    let [before, after] = [state.design.0[point], repeats]
                        .map(|repeats| self.points[point].duration_s(repeats));
                    (point, repeats, after - before)
                })
                .filter(|(_, _, cost_s)| *cost_s <= left_s)
                .collect();
            let few = state.design.measured().count() < FEWEST_POINTS;
            let is_new = |(point, _, _): &&(usize, usize, f64)| state.design.0[*point] == 0;
            let new: Vec<(usize, usize, f64)> = fitting.iter().filter(is_new).copied().collect();
            let mut candidates = if few && !new.is_empty() { new } else { fitting };
            if step % ALL_TRIED_EVERY != 0 {
                candidates.sort_by(|a, b| last[b.0].total_cmp(&last[a.0]));
                candidates.truncate(PROMISING);
            }
            let gains: Vec<f64> = candidates
                .par_iter()
                .map(|(point, repeats, cost_s)| {
                    (self.with(&state, *point, *repeats).score - state.score) / cost_s
                })
                .collect();
            candidates.iter().zip(&gains).for_each(|(candidate, gain)| last[candidate.0] = *gain);
            let best = candidates.iter().zip(gains).max_by(|a, b| a.1.total_cmp(&b.1));
            match best {
                Some(((point, repeats, _), _)) if !self.observer.cancelled() => {
                    state = self.with(&state, *point, *repeats);
                }
                _ => break,
            }
        }
        state
    }

    /// Exchanges points while that makes the design better.
    fn exchanged(&self, mut state: State) -> State {
        let mut exchanges = 0;
        'better: while exchanges < MOST_EXCHANGES {
            for point in self.least_useful(&state).into_iter().take(TRIED) {
                exchanges += 1;
                let without = self.with(&state, point, 0);
                let refilled = self.filled(self.state(&without.design));
                if refilled.score > state.score {
                    state = refilled;
                    continue 'better;
                }
            }
            break;
        }
        state
    }

    /// The points of a design, the one first that loses least per second if it is left out.
    fn least_useful(&self, state: &State) -> Vec<usize> {
        let measured: Vec<usize> = state.design.measured().collect();
        let lost: Vec<f64> = measured
            .par_iter()
            .map(|point| {
                let freed_s = self.points[*point].duration_s(state.design.0[*point]);
                (state.score - self.with(state, *point, 0).score) / freed_s
            })
            .collect();
        let mut by_loss: Vec<(usize, f64)> = measured.into_iter().zip(lost).collect();
        by_loss.sort_by(|a, b| a.1.total_cmp(&b.1));
        by_loss.into_iter().map(|(point, _)| point).collect()
    }
}
