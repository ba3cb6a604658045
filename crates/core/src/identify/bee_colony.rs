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

mod colony;

use std::ops::ControlFlow;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::ColonyOptions;
use colony::Colony;

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

/// Costs of points, evaluated in parallel; NaN becomes +∞.
pub(super) fn evaluate<O: Objective + ?Sized>(objective: &O, points: &[Vec<f64>]) -> Vec<f64> {
    let cost = |point: &Vec<f64>| match objective.cost(point) {
        cost if cost.is_nan() => f64::INFINITY,
        cost => cost,
    };
    points.par_iter().map(cost).collect()
}

/// A uniform draw from the cube.
pub fn uniform(dimension: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    (0..dimension).map(|_| rng.random_range(0.0..=1.0)).collect()
}

#[cfg(test)]
mod tests;
