//! The noise-weighted misfit: residuals, their Jacobian, and the sum of squares over all harmonics.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::measurement::Complex;
use crate::observer::Observer;
use crate::simulate::{self, Counts, LastMotion, NoResponse, Response};

use super::levenberg_marquardt::Linearisation;
use super::noise::Weights;
use super::parameters::{CONSTANT, Coordinates};
use super::problem::{Prepared, Problem};

/// The misfit of a problem as a function of its coordinates.
#[derive(Clone, Copy)]
pub(super) struct Misfit<'a> {
    /// The measurement.
    pub problem: &'a Problem,
    /// The coordinates.
    pub coordinates: &'a Coordinates,
    /// The standard deviation of each datum.
    pub weights: &'a Weights,
    /// The observer, who may cancel.
    pub observer: &'a dyn Observer,
    /// Predictions to use in experiments for which a model with effects has no periodic response.
    /// With `None`, such a model has infinite cost.
    pub stand_in: Option<&'a [Vec<Complex>]>,
    /// Which periodic motions count as a response.
    pub counts: Counts<'a>,
    /// The last motion of each experiment, from which the next simulation starts; without them,
    /// every simulation starts as `counts` says.
    pub motions: Option<&'a [LastMotion]>,
}

impl<'a> Misfit<'a> {
    /// The misfit of a model that must have a response from rest in every experiment.
    pub fn new(
        problem: &'a Problem,
        coordinates: &'a Coordinates,
        weights: &'a Weights,
        observer: &'a dyn Observer,
    ) -> Self {
        let (stand_in, counts) = (None, Counts::FromRest);
        Self { problem, coordinates, weights, observer, stand_in, counts, motions: None }
    }
}

/// A model at a point.
pub(super) struct Evaluation {
    /// Simulated value of every target, by experiment, in scale.
    pub predicted: Vec<Vec<Complex>>,
    /// The linearisation there.
    pub here: Linearisation,
}

/// Why a point has no residuals: the model has no response to an experiment, or the observer has
/// cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NoResiduals;

/// Largest share of the experiments in which a model may lack a response (tuned).
const LARGEST_UNANSWERED_SHARE: f64 = 0.1;

impl<'a> Misfit<'a> {
    /// Simulated value of every target, by experiment, in scale.
    ///
    /// # Errors
    /// When an experiment has no response and `stand_in` does not replace it, or when cancelled.
    pub fn predict(&self, point: &[f64]) -> Result<Vec<Vec<Complex>>, NoResiduals> {
        let plant = self.coordinates.plant(point);
        let effects = self.coordinates.effects_at(point);
        let predict = |e: usize, experiment: &Prepared| {
            let targets = &experiment.targets;
            if targets.is_empty() {
                return Ok(Vec::new());
            }
            let velocity = experiment.respond(self.counts_of(e), &plant, &effects)?;
            Ok(targets.iter().map(|t| velocity[t.order] * t.per_velocity).collect())
        };
        self.map_experiments(predict, |e| self.stand_in.map(|values| values[e].clone()))
    }

    /// A memory of the last motion of each experiment for the simulations of a fit, if others than those
    /// from rest count.
    pub fn new_motions(&self) -> Option<Vec<LastMotion>> {
        let from_rest = matches!(self.counts, Counts::FromRest);
        let each = || self.problem.experiments.iter().map(|_| LastMotion::default());
        (!from_rest).then(|| each().collect())
    }

    /// Which periodic motions of an experiment count.
    fn counts_of(&self, experiment: usize) -> Counts<'a> {
        self.motions.map_or(self.counts, |motions| Counts::Near(&motions[experiment]))
    }

    /// Applies `respond` to every experiment. `stand_in` supplies the result for the few
    /// experiments without a response. Simulations with effects are slow enough to be run on
    /// several threads. The observer is asked before each whether to go on.
    fn map_experiments<T: Send>(
        &self,
        respond: impl Fn(usize, &Prepared) -> Result<T, NoResponse> + Sync,
        stand_in: impl Fn(usize) -> Option<T> + Sync,
    ) -> Result<Vec<T>, NoResiduals> {
        let experiments = &self.problem.experiments;
        if self.coordinates.effects.is_empty() {
            let respond = |(e, experiment)| match self.observer.cancelled() {
                true => Err(NoResiduals),
                false => respond(e, experiment).map_err(|_| NoResiduals),
            };
            return experiments.iter().enumerate().map(respond).collect();
        }
        let most = (LARGEST_UNANSWERED_SHARE * experiments.len() as f64) as usize;
        let missing = AtomicUsize::new(0);
        let or_stand_in = |(e, experiment)| {
            if self.observer.cancelled() {
                return Err(NoResiduals);
            }
            respond(e, experiment).or_else(|_| {
                // Experiments without a response take longest to simulate, so stop at the first one
                // too many.
                let enough = missing.fetch_add(1, Ordering::Relaxed) >= most;
                if enough { Err(NoResiduals) } else { stand_in(e).ok_or(NoResiduals) }
            })
        };
        experiments.par_iter().enumerate().map(or_stand_in).collect()
    }

    /// Indices of the experiments with data in which the model has no response at this point; none
    /// once the observer cancels.
    pub fn unanswered(&self, point: &[f64]) -> Vec<usize> {
        let plant = self.coordinates.plant(point);
        let effects = self.coordinates.effects_at(point);
        let is_unanswered = |Prepared { excitation, highest, targets, .. }: &Prepared| {
            let response =
                || simulate::respond_if(self.counts, &plant, &effects, excitation, *highest);
            !targets.is_empty() && !self.observer.cancelled() && response().is_err()
        };
        let experiments = self.problem.experiments.par_iter().enumerate();
        experiments.filter(|(_, experiment)| is_unanswered(experiment)).map(|(e, _)| e).collect()
    }

    /// Residuals (Ŷ − Y)/σ, in the order of [`Linearisation::residuals`].
    pub fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResiduals> {
        let predicted = self.predict(point)?;
        let mut residuals = Vec::with_capacity(self.problem.data());
        for (e, experiment) in self.problem.experiments.iter().enumerate() {
            for (t, target) in experiment.targets.iter().enumerate() {
                let left = (predicted[e][t] - target.value) / self.weights.sigma[e][t];
                residuals.push(left.re);
                if !target.real {
                    residuals.push(left.im);
                }
            }
        }
        self.weights.reduce(&mut residuals);
        Ok(DVector::from_vec(residuals))
    }

    /// Residuals and their derivatives with respect to every coordinate.
    pub fn linearise(&self, point: &[f64]) -> Result<Linearisation, NoResiduals> {
        Ok(self.linearised(point, &self.differentiated(point)?))
    }

    /// Predictions, residuals and their derivatives, from one simulation.
    pub fn evaluate(&self, point: &[f64]) -> Result<Evaluation, NoResiduals> {
        let responses = self.differentiated(point)?;
        let experiments = self.problem.experiments.iter().zip(&responses);
        let predict = |(experiment, response): (&Prepared, &Response)| {
            let targets = experiment.targets.iter();
            targets.map(|target| response.velocity[target.order] * target.per_velocity).collect()
        };
        let predicted = experiments.map(predict).collect();
        Ok(Evaluation { predicted, here: self.linearised(point, &responses) })
    }

    /// The response to every experiment, with its sensitivities.
    fn differentiated(&self, point: &[f64]) -> Result<Vec<Response>, NoResiduals> {
        let plant = self.coordinates.variable_plant(point);
        let effects = self.coordinates.effects_at(point);
        let (base, columns) = (self.coordinates.base_len(), self.coordinates.len());
        let respond = |e: usize, experiment: &Prepared| {
            if experiment.targets.is_empty() {
                return Ok(Response { velocity: Vec::new(), sensitivities: Vec::new() });
            }
            experiment.respond_with_sensitivities(self.counts_of(e), (&plant, base), &effects)
        };
        self.map_experiments(respond, |e| {
            let targets = &self.problem.experiments[e].targets;
            let zero = vec![Complex::ZERO; self.problem.experiments[e].highest + 1];
            let mut velocity = zero.clone();
            for (target, value) in targets.iter().zip(&self.stand_in?[e]) {
                velocity[target.order] = value / target.per_velocity;
            }
            Some(Response { velocity, sensitivities: vec![zero; columns] })
        })
    }

    fn linearised(&self, point: &[f64], responses: &[Response]) -> Linearisation {
        let columns = self.coordinates.len();
        let slopes: Vec<f64> =
            point.iter().enumerate().map(|(i, x)| self.coordinates.value(i, *x).1).collect();
        let mut residuals = DVector::zeros(self.problem.data());
        let mut jacobian = DMatrix::zeros(self.problem.data(), columns);
        let mut row = 0;
        for (e, (experiment, response)) in
            self.problem.experiments.iter().zip(responses).enumerate()
        {
            for (t, target) in experiment.targets.iter().enumerate() {
                let k = target.order;
                let weight = target.per_velocity / self.weights.sigma[e][t];
                let measured = target.value / self.weights.sigma[e][t];
                let left = response.velocity[k] * weight - measured;
                residuals[row] = left.re;
                if !target.real {
                    residuals[row + 1] = left.im;
                }
                for (i, derivatives) in response.sensitivities.iter().enumerate() {
                    let slope = derivatives[k] * weight * slopes[i];
                    jacobian[(row, i)] = slope.re;
                    if !target.real {
                        jacobian[(row + 1, i)] = slope.im;
                    }
                }
                row += if target.real { 1 } else { 2 };
            }
        }
        self.weights.reduce(residuals.as_mut_slice());
        // Columns follow one another.
        for column in jacobian.as_mut_slice().chunks_exact_mut(residuals.len().max(1)) {
            self.weights.reduce(column);
        }
        Linearisation { residuals, jacobian }
    }

    /// Sum of squared residuals; infinite where there is no response.
    pub fn cost(&self, point: &[f64]) -> f64 {
        self.residuals(point).map_or(f64::INFINITY, |residuals| residuals.norm_squared())
    }

    /// Sets K to its best value given the other coordinates, and returns the cost there.
    ///
    /// The response is proportional to K, so the best K is the projection of the data on the
    /// response to K = 1. The search needs no dimension for it. What is eliminated counts as it
    /// was read: it is enough for a start.
    pub fn solve_for_constant(&self, point: &mut [f64]) -> f64 {
        point[CONSTANT] = 0.0;
        let Ok(unit) = self.predict(point) else { return f64::INFINITY };
        let (mut projection, mut size) = (0.0, 0.0);
        let every = || {
            self.problem.experiments.iter().enumerate().flat_map(|(e, experiment)| {
                experiment.targets.iter().enumerate().map(move |(t, target)| (e, t, target))
            })
        };
        for (e, t, target) in every() {
            let weight = self.weights.sigma[e][t].powi(-2);
            let (x, y) = (unit[e][t], target.value);
            let im = if target.real { 0.0 } else { 1.0 };
            projection += weight * (x.re * y.re + im * x.im * y.im);
            size += weight * (x.re * x.re + im * x.im * x.im);
        }
        let limits = (self.coordinates.lower[CONSTANT], self.coordinates.upper[CONSTANT]);
        point[CONSTANT] = (projection / size).ln().clamp(limits.0, limits.1);
        if projection.is_nan() || projection <= 0.0 {
            // The response is zero or opposes the data: use the smallest K.
            point[CONSTANT] = limits.0;
        }
        let constant = point[CONSTANT].exp();
        every()
            .map(|(e, t, target)| {
                let left = (constant * unit[e][t] - target.value) / self.weights.sigma[e][t];
                if target.real { left.re * left.re } else { left.norm_sqr() }
            })
            .sum()
    }
}
