//! Fits of small problems with known minima.

use nalgebra::DMatrix;

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

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, ()> {
        self.linearise(point).map(|here| here.residuals)
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

/// Residuals 1000(y − x²) and 1 − x.
struct SteepValley;

impl LeastSquares for SteepValley {
    type Error = ();

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, ()> {
        let [x, y] = [point[0], point[1]];
        Ok(DVector::from_vec(vec![1e3 * (y - x * x), 1.0 - x]))
    }

    fn linearise(&self, point: &[f64]) -> Result<Linearisation, ()> {
        let residuals = self.residuals(point)?;
        let jacobian = DMatrix::from_row_slice(2, 2, &[-2e3 * point[0], 1e3, -1.0, 0.0]);
        Ok(Linearisation { residuals, jacobian })
    }
}

// Without bends the fit is at x = −0.44 after 339 evaluations, its limit of steps.
#[test]
fn a_rejected_step_along_a_steep_valley_is_bent_into_it() {
    let found = minimise(&SteepValley, &[-1.2, 1.44], PATIENCE, &mut |_, _, _| ());
    assert!(found.point.iter().all(|x| (x - 1.0).abs() < 1e-6), "{found:?}");
    assert!(found.evaluations < 300, "{found:?}");
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

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, ()> {
        Ok(DVector::from_vec(vec![3.0, (self.value)(point[0])]))
    }

    fn linearise(&self, point: &[f64]) -> Result<Linearisation, ()> {
        let residuals = self.residuals(point)?;
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
