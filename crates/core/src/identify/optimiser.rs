//! The interface of a search, and its budget of evaluations.
//!
//! An [`Optimiser`] looks for the least cost in the unit cube \[0, 1\]ⁿ. A [`Search`] evaluates for it,
//! counts evaluations against one budget, keeps the best point, and reports to the observer. Searches can
//! therefore be compared by what they reach with equally many evaluations.

use std::convert::Infallible;
use std::ops::ControlFlow;

use rand_chacha::ChaCha8Rng;

use crate::answers::IdentifyOptions;

use super::bee_colony::{Objective, evaluate};

/// Where a descent by derivatives ended.
pub(super) struct Descent {
    /// The point; it may lie outside the cube.
    pub point: Vec<f64>,
    /// Its cost.
    pub cost: f64,
    /// Evaluations used, those with derivatives counted like those without.
    pub evaluations: usize,
}

/// An objective that knows its derivatives.
pub(super) trait Smooth: Objective {
    /// Goes down from a point until that pays no more, or for `most` evaluations; `on_step`
    /// hears of the evaluations so far and the cost.
    fn descend(&self, from: &[f64], most: usize, on_step: &mut dyn FnMut(usize, f64)) -> Descent;
}

/// Where a search stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Generation {
    /// Generation, cycle or step; 0 after the first points.
    pub index: usize,
    /// Evaluations so far.
    pub evaluations: usize,
    /// Least cost so far.
    pub best: f64,
    /// Mean cost of the population, where there is one and it is finite.
    pub mean: Option<f64>,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// Every evaluation it was allowed is spent.
    BudgetSpent,
    /// The colony has flown every cycle.
    EveryCycleFlown,
    /// Its steps have become too small to matter.
    Converged,
    /// It has gone down from every start.
    EveryStartDescended,
    /// Whoever watches asked for it.
    Cancelled,
}

impl Stop {
    /// The reason in words.
    pub fn reason(self) -> &'static str {
        match self {
            Stop::BudgetSpent => "evaluation budget spent",
            Stop::EveryCycleFlown => "every cycle flown",
            Stop::Converged => "converged",
            Stop::EveryStartDescended => "every start descended",
            Stop::Cancelled => "cancelled",
        }
    }
}

/// A search for the least cost.
pub(super) trait Optimiser: Sync {
    /// Name of its stage.
    fn stage(&self) -> &'static str;

    /// Whether the options leave it on.
    fn is_enabled(&self, _options: &IdentifyOptions) -> bool {
        true
    }

    /// Evaluations it may use: what the options say, or else what the colony of the paper uses.
    fn budget(&self, options: &IdentifyOptions) -> usize {
        options.search_budget()
    }

    /// Searches until something stops it.
    ///
    /// # Errors
    /// Always: what stopped it.
    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop>;
}

/// A search under way: the objective, the budget, the best point, the watcher.
pub(super) struct Search<'a> {
    /// What is to be made small.
    pub objective: &'a dyn Smooth,
    /// First points, the best guess first; there may be none.
    pub initial: &'a [Vec<f64>],
    /// Options of the job.
    pub options: &'a IdentifyOptions,
    /// Evaluations allowed.
    pub budget: usize,
    /// Hears of every generation; ends the search by breaking.
    pub watch: &'a mut dyn FnMut(&Generation) -> ControlFlow<()>,
    used: usize,
    generations: usize,
    best: Option<(Vec<f64>, f64)>,
}

impl<'a> Search<'a> {
    /// Nothing is evaluated yet.
    pub fn new(
        objective: &'a dyn Smooth,
        initial: &'a [Vec<f64>],
        options: &'a IdentifyOptions,
        budget: usize,
        watch: &'a mut dyn FnMut(&Generation) -> ControlFlow<()>,
    ) -> Self {
        let (used, generations, best) = (0, 0, None);
        Self { objective, initial, options, budget, watch, used, generations, best }
    }

    /// The best point and its cost, if any was finite.
    pub fn best(&self) -> Option<(&[f64], f64)> {
        self.best.as_ref().map(|(point, cost)| (point.as_slice(), *cost))
    }

    /// Evaluations used.
    pub fn used(&self) -> usize {
        self.used
    }

    /// Evaluations left.
    pub fn left(&self) -> usize {
        self.budget - self.used
    }

    /// Costs of points of the cube, evaluated in parallel; NaN counts as +∞.
    ///
    /// # Errors
    /// [`Stop::BudgetSpent`] where the budget does not last for all of them; those it lasts
    /// for count towards the best.
    pub fn evaluate(&mut self, points: &[Vec<f64>]) -> Result<Vec<f64>, Stop> {
        let affordable = &points[..points.len().min(self.left())];
        let costs = evaluate(self.objective, affordable);
        for (point, cost) in affordable.iter().zip(&costs) {
            self.offer(point, *cost);
        }
        self.used += affordable.len();
        if affordable.len() == points.len() {
            return Ok(costs);
        }
        self.report(None)?;
        Err(Stop::BudgetSpent)
    }

    /// Goes down from a point of the cube.
    ///
    /// # Errors
    /// [`Stop::Cancelled`].
    pub fn descend(&mut self, from: &[f64]) -> Result<(), Stop> {
        let (used, bar) = (self.used, self.best.as_ref().map_or(f64::INFINITY, |best| best.1));
        let Self { objective, generations, watch, .. } = self;
        let left = self.budget - used;
        let mut go_on = ControlFlow::Continue(());
        let descent = objective.descend(from, left, &mut |evaluations, cost| {
            let (evaluations, best) = (used + evaluations, cost.min(bar));
            let generation = Generation { index: *generations, evaluations, best, mean: None };
            *generations += 1;
            if go_on.is_continue() {
                go_on = watch(&generation);
            }
        });
        self.used += descent.evaluations;
        self.offer(&descent.point, descent.cost);
        if go_on.is_break() { Err(Stop::Cancelled) } else { Ok(()) }
    }

    /// Takes over what a search that evaluates by itself has found and spent.
    pub fn adopt(&mut self, point: &[f64], cost: f64, evaluations: usize) {
        self.used = evaluations;
        self.offer(point, cost);
    }

    /// Passes on what a search that evaluates by itself says of a generation.
    pub fn hear(
        &mut self,
        index: usize,
        evaluations: usize,
        best: f64,
        mean: Option<f64>,
    ) -> ControlFlow<()> {
        (self.watch)(&Generation { index, evaluations, best, mean })
    }

    /// A generation is done; `costs` are those of its population.
    ///
    /// # Errors
    /// [`Stop::Cancelled`] where the watcher asks for it.
    pub fn report(&mut self, costs: Option<&[f64]>) -> Result<(), Stop> {
        let finite: Vec<f64> =
            costs.unwrap_or_default().iter().copied().filter(|cost| cost.is_finite()).collect();
        let mean = (!finite.is_empty()).then(|| finite.iter().sum::<f64>() / finite.len() as f64);
        let best = self.best.as_ref().map_or(f64::INFINITY, |best| best.1);
        let generation = Generation { index: self.generations, evaluations: self.used, best, mean };
        self.generations += 1;
        match (self.watch)(&generation) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stop::Cancelled),
        }
    }

    fn offer(&mut self, point: &[f64], cost: f64) {
        if self.best.as_ref().map_or(f64::INFINITY, |best| best.1) > cost {
            self.best = Some((point.to_vec(), cost));
        }
    }

    /// So many first points: those given, then uniform draws.
    pub fn population(&self, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let within = |point: &Vec<f64>| point.iter().map(|x| x.clamp(0.0, 1.0)).collect();
        let mut points: Vec<Vec<f64>> = self.initial.iter().take(count).map(within).collect();
        points.resize_with(count, || super::bee_colony::uniform(self.objective.dimension(), rng));
        points
    }
}
