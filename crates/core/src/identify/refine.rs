//! Bounded Levenberg–Marquardt refinement.
//!
//! Levenberg's damping with Marquardt's scaling (1963, doi:10.1137/0111030) by the largest
//! curvature so far (Moré 1978, doi:10.1007/BFb0067700). Coordinates on a bound that the gradient
//! pushes outwards are held; steps are cut at the bounds.

use nalgebra::{DMatrix, DVector};

use super::objective::{Linearisation, Misfit};

/// When a refinement ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patience {
    /// Most steps.
    pub steps: usize,
    /// Most evaluations.
    pub evaluations: u64,
    /// Converged if a step lowers the cost by less than this share of cost + `negligible`.
    pub cost_tolerance: f64,
    /// Cost below which relative decreases do not matter: see `cost_tolerance`.
    pub negligible: f64,
}

/// To the accuracy of the arithmetic.
pub(super) const THOROUGH: Patience =
    Patience { steps: 100, evaluations: u64::MAX, cost_tolerance: 1e-14, negligible: 0.0 };

/// Converged if no coordinate moves by more than this (in logarithms or in units of the input).
const STEP_TOLERANCE: f64 = 1e-11;

/// Longest step of any coordinate: a factor of e, or the largest input.
const LONGEST_STEP: f64 = 1.0;

/// Where refinement ended.
#[derive(Debug, Clone)]
pub(super) struct Refined {
    /// The point.
    pub point: Vec<f64>,
    /// Its sum of squares.
    pub cost: f64,
    /// Number of simulations of the whole measurement.
    pub evaluations: u64,
    /// Why it ended.
    pub stop: &'static str,
}

/// Refines a point; `on_step` receives the step number, the evaluations and the cost.
pub(super) fn refine(
    misfit: &Misfit<'_>,
    start: &[f64],
    patience: Patience,
    on_step: &mut dyn FnMut(u64, u64, f64),
) -> Refined {
    let coordinates = misfit.coordinates;
    let mut point = start.to_vec();
    coordinates.clamp(&mut point);
    let mut evaluations = 1;
    let Ok(mut here) = misfit.linearise(&point) else {
        return Refined { point, cost: f64::INFINITY, evaluations, stop: "no response" };
    };
    let mut cost = here.residuals.norm_squared();
    let mut scaling = DVector::from_element(point.len(), 0.0);
    let mut damping = 1e-3;
    on_step(0, evaluations, cost);
    for step in 1..=patience.steps {
        if misfit.observer.cancelled() {
            return Refined { point, cost, evaluations, stop: "cancelled" };
        }
        // A step takes at least two evaluations: a trial, and the derivatives at the new point.
        let spent = |evaluations: u64| evaluations + 2 > patience.evaluations;
        let gradient = here.jacobian.tr_mul(&here.residuals);
        let curvature = here.jacobian.tr_mul(&here.jacobian);
        for i in 0..point.len() {
            scaling[i] = curvature[(i, i)].max(scaling[i]).max(f64::MIN_POSITIVE);
        }
        let mut accepted = None;
        while damping < 1e15 {
            let trial = damped_step(misfit, &point, &gradient, &curvature, &scaling, damping);
            let moved = trial.iter().zip(&point).map(|(t, p)| (t - p).abs()).fold(0.0, f64::max);
            if moved <= f64::EPSILON {
                break;
            }
            if spent(evaluations) {
                return Refined { point, cost, evaluations, stop: "evaluation budget spent" };
            }
            evaluations += 1;
            let trial_cost = misfit.cost(&trial);
            if trial_cost < cost {
                accepted = Some((trial, trial_cost, moved));
                damping = (damping * 0.1).max(1e-12);
                break;
            }
            damping *= if damping < 1e-6 { 100.0 } else { 5.0 };
        }
        let Some((trial, trial_cost, moved)) = accepted else {
            return Refined { point, cost, evaluations, stop: "no further descent" };
        };
        let decrease = cost - trial_cost;
        point = trial;
        evaluations += 1;
        match misfit.linearise(&point) {
            Ok(linearisation) => here = linearisation,
            Err(_) => return Refined { point, cost: trial_cost, evaluations, stop: "no response" },
        }
        let matters = patience.cost_tolerance * (cost + patience.negligible);
        let converged = decrease <= matters || moved < STEP_TOLERANCE;
        cost = trial_cost;
        on_step(step as u64, evaluations, cost);
        if converged {
            return Refined { point, cost, evaluations, stop: "converged" };
        }
    }
    Refined { point, cost, evaluations, stop: "step limit" }
}

/// The damped step within the bounds, with no coordinate moved by more than [`LONGEST_STEP`]. The
/// coordinate that exceeds its limit most is set to the limit, and the others are solved for again.
/// A coordinate that the data does not determine thus does not shorten the step of the others.
fn damped_step(
    misfit: &Misfit<'_>,
    point: &[f64],
    gradient: &DVector<f64>,
    curvature: &DMatrix<f64>,
    scaling: &DVector<f64>,
    damping: f64,
) -> Vec<f64> {
    let coordinates = misfit.coordinates;
    let limits = |i: usize| {
        let least = (coordinates.lower[i] - point[i]).max(-LONGEST_STEP);
        let most = (coordinates.upper[i] - point[i]).min(LONGEST_STEP);
        [least, most]
    };
    let mut free = free_coordinates(misfit, point, gradient);
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
    coordinates.clamp(&mut trial);
    trial
}

/// Indices of the coordinates that are not held: held ones lie on a bound that the gradient pushes
/// them against.
fn free_coordinates(misfit: &Misfit<'_>, point: &[f64], gradient: &DVector<f64>) -> Vec<usize> {
    let coordinates = misfit.coordinates;
    (0..point.len())
        .filter(|i| {
            let held_below = point[*i] <= coordinates.lower[*i] && gradient[*i] > 0.0;
            let held_above = point[*i] >= coordinates.upper[*i] && gradient[*i] < 0.0;
            !(held_below || held_above)
        })
        .collect()
}

/// Which coordinates are held by a bound at a refined point.
pub(super) fn held(misfit: &Misfit<'_>, point: &[f64], here: &Linearisation) -> Vec<bool> {
    let gradient = here.jacobian.tr_mul(&here.residuals);
    let free = free_coordinates(misfit, point, &gradient);
    let on_bound = |i: usize| {
        point[i] <= misfit.coordinates.lower[i] || point[i] >= misfit.coordinates.upper[i]
    };
    (0..point.len()).map(|i| !free.contains(&i) || on_bound(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, joined, stepped_sine};
    use super::super::noise;
    use super::super::parameters::Coordinates;
    use super::super::problem::Problem;
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::measurement::Measurement;
    use crate::observer::{Observer, Silent};
    use crate::plant::{Friction, Plant};

    struct Impatient;

    impl Observer for Impatient {
        fn cancelled(&self) -> bool {
            true
        }
    }

    /// Refines from the middle of the search range.
    fn refined(
        measurement: &Measurement,
        order: u8,
        observer: &dyn Observer,
    ) -> (Refined, Vec<bool>, Plant) {
        let problem = Problem::new(measurement).unwrap();
        let coordinates = Coordinates::new(order, false, &problem.prior);
        let weights = noise::weights(measurement, &problem, &IdentifyOptions::default(), None);
        let misfit = Misfit::new(&problem, &coordinates, &weights, observer);
        let mut start = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
        misfit.solve_for_constant(&mut start);
        let refined = refine(&misfit, &start, THOROUGH, &mut |_, _, _| ());
        let held = held(&misfit, &refined.point, &misfit.linearise(&refined.point).unwrap());
        let found = problem.in_units(&coordinates.plant(&refined.point));
        (refined, held, found)
    }

    // The data comes from the independent simulator, which errs by 1e-9 of the largest value.
    // Squared and summed over some 200 data this is about 1e-16. A parameter errs by some ten times
    // 1e-9.
    #[test]
    fn refinement_from_the_middle_of_the_range_ends_at_the_truth() {
        for actuator in ACTUATORS {
            let measurement = stepped_sine(&axis(actuator), 5);
            let (refined, held, found) = refined(&measurement, actuator.order(), &Silent);
            assert!(refined.cost < 1e-16, "{refined:?}");
            assert!((found.viscous_rate_rad_s - 10.0).abs() < 1e-6);
            assert!((found.friction.fc_minus - 0.4).abs() < 1e-7);
            assert!(held.iter().all(|held| !held));
        }
    }

    // The mean is lowered until no friction explains it, and the fit asks for a level below 0.
    #[test]
    fn a_level_the_data_wants_below_zero_ends_held_by_its_bound() {
        let plant = Plant { friction: Friction::coulomb(0.5, 0.0), ..axis(ACTUATORS[0]) };
        let mut experiments = stepped_sine(&plant, 5).experiments().to_vec();
        experiments.iter_mut().for_each(|e| e.response[0].value -= 0.01);
        let (_, held, found) = refined(&joined(experiments), 0, &Silent);
        assert_eq!(held, [false, false, false, true]);
        assert_eq!(found.friction.fc_minus, 0.0);
    }

    // The axis has no actuator, and the data cannot distinguish a fast one from none, so its corner
    // goes to the bound. If a limit on that coordinate shortened the whole step, the others would
    // advance slowly. Quadratic convergence from the middle of the range takes some ten steps of
    // two evaluations; 60 leave room.
    #[test]
    fn an_undetermined_coordinate_does_not_slow_the_others() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 5);
        let (refined, held, found) = refined(&measurement, 1, &Silent);
        assert_eq!(held, [false, false, false, false, true]);
        assert!((found.viscous_rate_rad_s - 10.0).abs() < 1e-3, "{found:?}");
        assert!(refined.evaluations < 60, "{refined:?}");
    }

    #[test]
    fn a_cancelled_refinement_takes_no_step() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 5);
        let (refined, _, _) = refined(&measurement, 0, &Impatient);
        assert_eq!((refined.stop, refined.evaluations), ("cancelled", 1));
    }
}
