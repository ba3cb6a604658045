//! Bounded nonlinear least squares by the Levenberg–Marquardt method.
//!
//! Levenberg's damping with Marquardt's scaling (1963, doi:10.1137/0111030) by the largest
//! curvature so far (Moré 1978, doi:10.1007/BFb0067700). Coordinates on a bound that the gradient
//! pushes outwards are held; steps are cut at the bounds. Where a fit takes many steps, it follows a
//! curved valley, and a step that was rejected is bent by the curvature that it showed (after Transtrum
//! and Sethna's geodesic acceleration 2012, arXiv:1201.5885).

mod damped_step;
mod least_squares;

use nalgebra::DVector;

pub(super) use damped_step::held;
use damped_step::{DampedSystem, bent};
pub(super) use least_squares::{LeastSquares, Linearisation};

/// When a refinement ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patience {
    /// Most steps.
    pub steps: usize,
    /// Most evaluations.
    pub evaluations: u64,
    /// Converged if a step lowers the cost by less than this share of cost + `negligible`, or is
    /// predicted to.
    pub cost_tolerance: f64,
    /// Cost below which relative decreases do not matter: see `cost_tolerance`.
    pub negligible: f64,
    /// Damping of the first step, relative to the scaled curvature.
    pub damping: f64,
    /// Converged if the first step lowers the cost by as much as predicted, to within this share of
    /// the prediction: the model is linear over the step, and a second one would gain nothing. With
    /// 0 the fit goes on.
    pub linear_within: f64,
}

/// Damping of the first step where nothing is known of the problem.
pub(super) const FIRST_DAMPING: f64 = 1e-3;

/// Converged if no coordinate moves by more than this.
const STEP_TOLERANCE: f64 = 1e-11;

/// A rejected trial whose cost exceeds that of the point by more than this factor lies where the
/// linearised residuals say nothing, so that their prediction for the next, shorter step is not
/// trusted (tuned).
const PREDICTABLE_GROWTH: f64 = 2.0;

/// Steps after which rejected trials are bent (tuned). Most fits end before.
const STRAIGHT_STEPS: usize = 6;

/// Decreases of a cost by less than this share are lost in the rounding of their prediction.
const LEAST_PREDICTED_SHARE: f64 = 1e-12;

/// Where refinement ended.
#[derive(Debug, Clone)]
pub(super) struct Refined {
    /// The point.
    pub point: Vec<f64>,
    /// Its sum of squares.
    pub cost: f64,
    /// Evaluations of the residuals, with or without their derivatives.
    pub evaluations: u64,
    /// The damping that a further step would have had.
    pub damping: f64,
    /// Why it ended.
    pub stop: &'static str,
}

/// Minimises from a point; `on_step` sees the step number, evaluations and cost.
pub(super) fn minimise<P: LeastSquares>(
    problem: &P,
    start: &[f64],
    patience: Patience,
    on_step: &mut dyn FnMut(u64, u64, f64),
) -> Refined {
    let mut point = start.to_vec();
    problem.clamp(&mut point);
    match problem.linearise(&point) {
        Ok(here) => minimise_from(problem, point, here, 1, patience, on_step),
        Err(_) => {
            let stop = if problem.cancelled() { "cancelled" } else { "no response" };
            let damping = patience.damping;
            Refined { point, cost: f64::INFINITY, evaluations: 1, damping, stop }
        }
    }
}

/// The same from a point within the bounds whose linearisation is known already, after so many
/// evaluations.
pub(super) fn minimise_from<P: LeastSquares>(
    problem: &P,
    mut point: Vec<f64>,
    mut here: Linearisation,
    mut evaluations: u64,
    patience: Patience,
    on_step: &mut dyn FnMut(u64, u64, f64),
) -> Refined {
    let mut cost = here.residuals.norm_squared();
    let mut scaling = DVector::from_element(point.len(), 0.0);
    let mut damping = patience.damping;
    // Residuals and derivatives are computed together at the first trial of a step as long as such
    // trials succeed: separately, they would take two simulations of the same point.
    let mut eager = patience.linear_within <= 0.0;
    on_step(0, evaluations, cost);
    for step in 1..=patience.steps {
        if problem.cancelled() {
            return Refined { point, cost, evaluations, damping, stop: "cancelled" };
        }
        // A step may take two evaluations: a trial, and the derivatives at the new point.
        let spent = |evaluations: u64| evaluations + 2 > patience.evaluations;
        let gradient = here.jacobian.tr_mul(&here.residuals);
        let curvature = here.jacobian.tr_mul(&here.jacobian);
        for i in 0..point.len() {
            scaling[i] = curvature[(i, i)].max(scaling[i]).max(f64::MIN_POSITIVE);
        }
        let matters = patience.cost_tolerance * (cost + patience.negligible);
        let mut accepted = None;
        let mut rejected = 0;
        let mut last_cost = cost;
        while damping < 1e15 {
            let system = DampedSystem { curvature: &curvature, scaling: &scaling, damping };
            let trial = system.step(problem, &point, &gradient);
            let shift = DVector::from_fn(point.len(), |i, _| trial[i] - point[i]);
            let moved = shift.amax();
            if moved <= f64::EPSILON {
                break;
            }
            // A trial costs a simulation: none is made for a decrease that would not matter. Where
            // every decrease matters, rounding decides, and the prediction is not asked.
            let predicted = -shift.dot(&(2.0 * &gradient + &curvature * &shift));
            let asked = patience.cost_tolerance > LEAST_PREDICTED_SHARE;
            if asked && predicted <= matters && last_cost <= PREDICTABLE_GROWTH * cost {
                return Refined { point, cost, evaluations, damping, stop: "converged" };
            }
            if spent(evaluations) {
                return Refined {
                    point,
                    cost,
                    evaluations,
                    damping,
                    stop: "evaluation budget spent",
                };
            }
            evaluations += 1;
            let (residuals, ahead) = if eager && rejected == 0 {
                let there = problem.linearise(&trial).ok();
                (there.as_ref().map(|there| there.residuals.clone()), there)
            } else {
                (problem.residuals(&trial).ok(), None)
            };
            let cost_of = |residuals: Option<&DVector<f64>>| {
                residuals.map_or(f64::INFINITY, DVector::norm_squared)
            };
            let trial_cost = cost_of(residuals.as_ref());
            if trial_cost < cost {
                accepted = Some((trial, trial_cost, moved, ahead, predicted));
                damping = (damping * 0.1).max(1e-12);
                break;
            }
            let bends = rejected == 0 && step > STRAIGHT_STEPS && !spent(evaluations);
            let beyond = residuals.filter(|_| bends).and_then(|there| {
                let unforeseen = there - &here.residuals - &here.jacobian * &shift;
                bent(problem, &system, (&trial, &shift), &here.jacobian.tr_mul(&unforeseen))
            });
            if let Some(trial) = beyond {
                evaluations += 1;
                let trial_cost = cost_of(problem.residuals(&trial).ok().as_ref());
                if trial_cost < cost {
                    accepted = Some((trial, trial_cost, moved, None, predicted));
                    damping = (damping * 0.1).max(1e-12);
                    rejected += 1;
                    break;
                }
            }
            rejected += 1;
            last_cost = trial_cost;
            damping *= if damping < 1e-6 { 100.0 } else { 5.0 };
        }
        let Some((trial, trial_cost, moved, ahead, predicted)) = accepted else {
            return Refined { point, cost, evaluations, damping, stop: "no further descent" };
        };
        eager = rejected == 0;
        let decrease = cost - trial_cost;
        point = trial;
        if step == 1 && (decrease - predicted).abs() < patience.linear_within * predicted {
            on_step(1, evaluations, trial_cost);
            return Refined { point, cost: trial_cost, evaluations, damping, stop: "converged" };
        }
        here = match ahead {
            Some(there) => there,
            None => {
                evaluations += 1;
                match problem.linearise(&point) {
                    Ok(there) => there,
                    Err(_) => {
                        let (cost, stop) = (trial_cost, "no response");
                        return Refined { point, cost, evaluations, damping, stop };
                    }
                }
            }
        };
        let converged = decrease <= matters || moved < STEP_TOLERANCE;
        cost = trial_cost;
        on_step(step as u64, evaluations, cost);
        if converged {
            return Refined { point, cost, evaluations, damping, stop: "converged" };
        }
    }
    Refined { point, cost, evaluations, damping, stop: "step limit" }
}

#[cfg(test)]
mod tests;
