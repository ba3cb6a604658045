//! Bounded nonlinear least squares by the Levenberg–Marquardt method.
//!
//! Levenberg's damping with Marquardt's scaling (1963, doi:10.1137/0111030) by the largest
//! curvature so far (Moré 1978, doi:10.1007/BFb0067700). Coordinates on a bound that the gradient
//! pushes outwards are held; steps are cut at the bounds.

use nalgebra::{DMatrix, DVector};

/// Residuals and their Jacobian.
#[derive(Debug, Clone)]
pub(super) struct Linearisation {
    /// Residuals; of a misfit (Ŷ − Y)/σ: real and imaginary part of each datum in turn, harmonic 0
    /// with its real part alone.
    pub residuals: DVector<f64>,
    /// One row for each residual, one column for each coordinate.
    pub jacobian: DMatrix<f64>,
}

/// A sum of squares to be minimised. Its coordinates are scaled so that 1 is the longest sensible
/// step.
pub(super) trait LeastSquares {
    /// Why a point has no residuals.
    type Error;

    /// The sum of squares at a point; infinite where it has no residuals.
    fn cost(&self, point: &[f64]) -> f64;

    /// Residuals and their derivatives at a point.
    fn linearise(&self, point: &[f64]) -> Result<Linearisation, Self::Error>;

    /// Lower and upper bound of a coordinate.
    fn bounds(&self, _coordinate: usize) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Moves a point onto the bounds it exceeds.
    fn clamp(&self, point: &mut [f64]) {
        for (i, value) in point.iter_mut().enumerate() {
            let [least, most] = self.bounds(i);
            *value = value.clamp(least, most);
        }
    }

    /// Whether to stop before the next step.
    fn cancelled(&self) -> bool {
        false
    }
}

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

/// Longest step of any coordinate.
const LONGEST_STEP: f64 = 1.0;

/// A rejected trial whose cost exceeds that of the point by more than this factor lies where the
/// linearised residuals say nothing, so that their prediction for the next, shorter step is not
/// trusted (tuned).
const PREDICTABLE_GROWTH: f64 = 2.0;

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
            let trial = damped_step(problem, &point, &gradient, &curvature, &scaling, damping);
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
            let (trial_cost, ahead) = if eager && rejected == 0 {
                let there = problem.linearise(&trial).ok();
                (there.as_ref().map_or(f64::INFINITY, |t| t.residuals.norm_squared()), there)
            } else {
                (problem.cost(&trial), None)
            };
            if trial_cost < cost {
                accepted = Some((trial, trial_cost, moved, ahead, predicted));
                damping = (damping * 0.1).max(1e-12);
                break;
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

/// The damped step within the bounds, with no coordinate moved by more than [`LONGEST_STEP`]. The
/// coordinate that exceeds its limit most is set to the limit, and the others are solved for again.
/// A coordinate that the data does not determine thus does not shorten the step of the others.
fn damped_step(
    problem: &impl LeastSquares,
    point: &[f64],
    gradient: &DVector<f64>,
    curvature: &DMatrix<f64>,
    scaling: &DVector<f64>,
    damping: f64,
) -> Vec<f64> {
    let limits = |i: usize| {
        let [lower, upper] = problem.bounds(i);
        [(lower - point[i]).max(-LONGEST_STEP), (upper - point[i]).min(LONGEST_STEP)]
    };
    let mut free = free_coordinates(problem, point, gradient);
    let mut step = DVector::zeros(point.len());
    while !free.is_empty() {
        let pushed = gradient + curvature * &step;
        let right = DVector::from_fn(free.len(), |r, _| -pushed[free[r]]);
        let mut system = curvature.select_rows(&free).select_columns(&free);
        for (r, i) in free.iter().enumerate() {
            system[(r, r)] += damping * scaling[*i];
        }
        let Some(factor) = system.cholesky() else { return point.to_vec() };
        let found = factor.solve(&right);
        let beyond = |r: usize| {
            let [least, most] = limits(free[r]);
            (least - found[r]).max(found[r] - most)
        };
        let worst = (0..free.len()).max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)));
        match worst.filter(|r| beyond(*r) > 0.0) {
            Some(r) => {
                let i = free.remove(r);
                let [least, most] = limits(i);
                step[i] = found[r].clamp(least, most);
            }
            None => {
                free.iter().enumerate().for_each(|(r, i)| step[*i] = found[r]);
                break;
            }
        }
    }
    let mut trial: Vec<f64> = point.iter().zip(&step).map(|(p, s)| p + s).collect();
    problem.clamp(&mut trial);
    trial
}

/// Coordinates that are not held by a bound the cost pushes them against.
fn free_coordinates(
    problem: &impl LeastSquares,
    point: &[f64],
    gradient: &DVector<f64>,
) -> Vec<usize> {
    (0..point.len())
        .filter(|i| {
            let [lower, upper] = problem.bounds(*i);
            let held_below = point[*i] <= lower && gradient[*i] > 0.0;
            let held_above = point[*i] >= upper && gradient[*i] < 0.0;
            !(held_below || held_above)
        })
        .collect()
}

/// Which coordinates are held by a bound at a point.
pub(super) fn held(problem: &impl LeastSquares, point: &[f64], here: &Linearisation) -> Vec<bool> {
    let gradient = here.jacobian.tr_mul(&here.residuals);
    let free = free_coordinates(problem, point, &gradient);
    let on_bound = |i: usize| {
        let [lower, upper] = problem.bounds(i);
        point[i] <= lower || point[i] >= upper
    };
    (0..point.len()).map(|i| !free.contains(&i) || on_bound(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Patience = Patience {
        steps: 100,
        evaluations: u64::MAX,
        cost_tolerance: 1e-14,
        negligible: 0.0,
        damping: FIRST_DAMPING,
        linear_within: 0.0,
    };

    /// Rosenbrock's function as a sum of squares, 10(y − x²) and 1 − x: least at (1, 1). Its x
    /// has an upper bound.
    struct Rosenbrock(f64);

    impl LeastSquares for Rosenbrock {
        type Error = ();

        fn cost(&self, point: &[f64]) -> f64 {
            self.linearise(point).map_or(f64::INFINITY, |here| here.residuals.norm_squared())
        }

        fn linearise(&self, point: &[f64]) -> Result<Linearisation, ()> {
            let [x, y] = [point[0], point[1]];
            let residuals = DVector::from_vec(vec![10.0 * (y - x * x), 1.0 - x]);
            let jacobian = DMatrix::from_row_slice(2, 2, &[-20.0 * x, 10.0, -1.0, 0.0]);
            if x.is_finite() { Ok(Linearisation { residuals, jacobian }) } else { Err(()) }
        }

        fn bounds(&self, coordinate: usize) -> [f64; 2] {
            [f64::NEG_INFINITY, if coordinate == 0 { self.0 } else { f64::INFINITY }]
        }
    }

    fn minimum(problem: &Rosenbrock, start: [f64; 2]) -> Refined {
        minimise(problem, &start, PATIENCE, &mut |_, _, _| ())
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let found = minimum(&Rosenbrock(f64::INFINITY), [-1.2, 1.0]);
        assert!(found.point.iter().all(|x| (x - 1.0).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn a_bound_holds_its_coordinate_and_lets_the_others_go() {
        let problem = Rosenbrock(0.5);
        let found = minimum(&problem, [-1.2, 1.0]);
        assert!(found.point[0] == 0.5 && (found.point[1] - 0.25).abs() < 1e-9, "{found:?}");
        let here = problem.linearise(&found.point).unwrap();
        assert_eq!(held(&problem, &found.point, &here), [true, false]);
    }

    /// Residuals 3 and r(x) of one coordinate x.
    struct Curve {
        value: fn(f64) -> f64,
        slope: fn(f64) -> f64,
    }

    impl LeastSquares for Curve {
        type Error = ();

        fn cost(&self, point: &[f64]) -> f64 {
            9.0 + (self.value)(point[0]).powi(2)
        }

        fn linearise(&self, point: &[f64]) -> Result<Linearisation, ()> {
            let residuals = DVector::from_vec(vec![3.0, (self.value)(point[0])]);
            let jacobian = DMatrix::from_column_slice(2, 1, &[0.0, (self.slope)(point[0])]);
            Ok(Linearisation { residuals, jacobian })
        }
    }

    fn coarse_minimum(problem: &Curve, start: f64, cost_tolerance: f64) -> Refined {
        let patience = Patience { cost_tolerance, ..PATIENCE };
        minimise(problem, &[start], patience, &mut |_, _, _| ())
    }

    // The least cost is 9; at x = 0.05 it is larger by 0.0025, less than a thousandth.
    #[test]
    fn no_trial_is_made_for_a_decrease_that_does_not_matter() {
        let line = Curve { value: |x| x, slope: |_| 1.0 };
        let found = coarse_minimum(&line, 0.05, 1e-3);
        assert_eq!((found.stop, found.evaluations, found.point[0]), ("converged", 1, 0.05));
        assert!(coarse_minimum(&line, 0.05, 1e-4).point[0].abs() < 1e-3);
    }

    #[test]
    fn a_fit_that_trusts_its_prediction_ends_after_one_trial_where_the_residuals_are_linear() {
        let trusting = |problem: &Curve| {
            let patience = Patience { linear_within: 0.05, damping: 0.0, ..PATIENCE };
            minimise(problem, &[1.0], patience, &mut |_, _, _| ())
        };
        let line = Curve { value: |x| x, slope: |_| 1.0 };
        let found = trusting(&line);
        assert_eq!((found.stop, found.evaluations, found.cost), ("converged", 2, 9.0));
        // From 1 a step to ½ is predicted to reach 0 and leaves a quarter.
        let parabola = Curve { value: |x| x * x, slope: |x| 2.0 * x };
        let found = trusting(&parabola);
        assert!(found.evaluations > 4 && found.point[0].abs() < 1e-2, "{found:?}");
    }

    // At 0 the slope promises little, and the longest step ends on the wall beyond the valley,
    // whose ground is at √0.15 = 0.387.
    #[test]
    fn a_trial_far_up_does_not_end_the_search_for_a_shorter_step() {
        let valley = Curve {
            value: |x| 5.0 - 0.06 * x - 15.0 * x.powi(2) + 50.0 * x.powi(4),
            slope: |x| -0.06 - 30.0 * x + 200.0 * x.powi(3),
        };
        let [predicted, matters] = [2.0 * 5.0 * 0.06, 0.01 * (9.0 + 25.0)];
        assert!(predicted > matters && 0.387 * predicted < matters);
        let found = coarse_minimum(&valley, 0.0, 0.01);
        assert!((found.point[0] - 0.387).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn a_start_without_residuals_has_no_cost() {
        let found = minimum(&Rosenbrock(f64::INFINITY), [f64::INFINITY, 0.0]);
        assert_eq!((found.stop, found.evaluations), ("no response", 1));
        assert_eq!(found.cost, f64::INFINITY);
    }
}
