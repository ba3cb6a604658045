//! The interface of a search, and its budget of evaluations.
//!
//! An [`Optimiser`] looks for the least cost in the unit cube \[0, 1\]ⁿ. A [`Search`] evaluates
//! points for it, counts evaluations against one budget, keeps the best point, and reports to the
//! observer. All searches can therefore be compared at equal numbers of evaluations.

use std::convert::Infallible;
use std::ops::ControlFlow;

use rand_chacha::ChaCha8Rng;

use crate::answers::IdentifyOptions;

use super::bee_colony::{Objective, evaluate};

/// The end of a descent with derivatives.
pub struct Descent {
    /// The point; it may lie outside the cube.
    pub point: Vec<f64>,
    /// Its cost.
    pub cost: f64,
    /// Evaluations used; one with derivatives counts like one without.
    pub evaluations: usize,
}

/// An objective with derivatives.
pub trait Smooth: Objective {
    /// Descends from a point until convergence, or for at most `most` evaluations; `on_step`
    /// receives the evaluations so far and the cost.
    fn descend(&self, from: &[f64], most: usize, on_step: &mut dyn FnMut(usize, f64)) -> Descent;
}

/// The state of a search after a generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generation {
    /// Generation, cycle or step; 0 after the initial points.
    pub index: usize,
    /// Evaluations so far.
    pub evaluations: usize,
    /// Least cost so far.
    pub best: f64,
    /// Mean of the finite costs of the population, if there are any.
    pub mean: Option<f64>,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// All allowed evaluations are used.
    BudgetSpent,
    /// The colony has completed all cycles.
    EveryCycleEnded,
    /// The steps have become negligible.
    Converged,
    /// A descent from every start is done.
    EveryStartDescended,
    /// The observer cancelled.
    Cancelled,
}

impl Stop {
    /// The reason in words.
    pub fn reason(self) -> &'static str {
        match self {
            Stop::BudgetSpent => "evaluation budget spent",
            Stop::EveryCycleEnded => "every cycle ended",
            Stop::Converged => "converged",
            Stop::EveryStartDescended => "every start descended",
            Stop::Cancelled => "cancelled",
        }
    }
}

/// A search for the least cost.
pub trait Optimiser: Sync {
    /// Name of the stage.
    fn stage(&self) -> &'static str;

    /// Whether the options enable it.
    fn is_enabled(&self, _options: &IdentifyOptions) -> bool {
        true
    }

    /// Evaluations it may use: as the options say, or else as many as the paper's colony uses.
    fn budget(&self, options: &IdentifyOptions) -> usize {
        options.search_budget()
    }

    /// Searches until something stops it.
    ///
    /// # Errors
    /// Always: the reason why it stopped.
    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop>;
}

/// A search in progress: the objective, the budget, the best point, the observer.
pub struct Search<'a> {
    /// The function to minimise.
    pub objective: &'a dyn Smooth,
    /// Initial points, the best guess first; may be empty.
    pub initial: &'a [Vec<f64>],
    /// Options of the job.
    pub options: &'a IdentifyOptions,
    /// Evaluations allowed.
    pub budget: usize,
    /// Called after every generation; ends the search by breaking.
    pub watch: &'a mut dyn FnMut(&Generation) -> ControlFlow<()>,
    used: usize,
    generations: usize,
    best: Option<(Vec<f64>, f64)>,
}

impl<'a> Search<'a> {
    /// A search with nothing evaluated yet.
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

    /// The best point and its cost, if any cost was finite.
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

    /// Costs of points of the cube, evaluated in parallel; NaN becomes +∞.
    ///
    /// # Errors
    /// [`Stop::BudgetSpent`] if the budget does not suffice for all points. Those that were
    /// evaluated still count towards the best.
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

    /// Descends from a point of the cube.
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

    /// Takes over the best point and the number of evaluations of a search that evaluates by
    /// itself.
    pub fn adopt(&mut self, point: &[f64], cost: f64, evaluations: usize) {
        self.used = evaluations;
        self.offer(point, cost);
    }

    /// Passes on a generation of a search that evaluates by itself.
    pub fn pass_on(
        &mut self,
        index: usize,
        evaluations: usize,
        best: f64,
        mean: Option<f64>,
    ) -> ControlFlow<()> {
        (self.watch)(&Generation { index, evaluations, best, mean })
    }

    /// Reports the end of a generation; `costs` are those of its population.
    ///
    /// # Errors
    /// [`Stop::Cancelled`] if the observer asks for it.
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

    /// Keeps a point if it is the best so far.
    fn offer(&mut self, point: &[f64], cost: f64) {
        if self.best.as_ref().map_or(f64::INFINITY, |best| best.1) > cost {
            self.best = Some((point.to_vec(), cost));
        }
    }

    /// `count` initial points: those given, then uniform draws.
    pub fn population(&self, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let within = |point: &Vec<f64>| point.iter().map(|x| x.clamp(0.0, 1.0)).collect();
        let mut points: Vec<Vec<f64>> = self.initial.iter().take(count).map(within).collect();
        points.resize_with(count, || super::bee_colony::uniform(self.objective.dimension(), rng));
        points
    }
}
