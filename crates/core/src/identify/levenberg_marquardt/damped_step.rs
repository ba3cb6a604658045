//! The damped step within bounds, and the coordinates that a bound holds.

use nalgebra::{DMatrix, DVector};

use super::least_squares::{LeastSquares, Linearisation};

/// Longest step of any coordinate.
const LONGEST_STEP: f64 = 1.0;

/// The longest bend of a step, as a share of it, both scaled (tuned): beyond, the curvature of the residuals
/// is no small correction.
const LONGEST_BEND: f64 = 0.375;

/// The system of equations of a damped step: JᵀJ + λ·D.
pub(super) struct DampedSystem<'a> {
    /// JᵀJ.
    pub curvature: &'a DMatrix<f64>,
    /// The diagonal of D.
    pub scaling: &'a DVector<f64>,
    /// λ.
    pub damping: f64,
}

impl DampedSystem<'_> {
    /// The solution in these coordinates; `None` if the system is singular.
    fn solve(&self, free: &[usize], right: &DVector<f64>) -> Option<DVector<f64>> {
        let mut system = self.curvature.select_rows(free).select_columns(free);
        for (r, i) in free.iter().enumerate() {
            system[(r, r)] += self.damping * self.scaling[*i];
        }
        Some(system.cholesky()?.solve(right))
    }

    /// The damped step within the bounds, with no coordinate moved by more than [`LONGEST_STEP`]. The
    /// coordinate that exceeds its limit most is set to the limit, and the others are solved for again.
    /// A coordinate that the data does not determine thus does not shorten the step of the others.
    pub(super) fn step(
        &self,
        problem: &impl LeastSquares,
        point: &[f64],
        gradient: &DVector<f64>,
    ) -> Vec<f64> {
        let limits = |i: usize| {
            let [lower, upper] = problem.bounds(i);
            [(lower - point[i]).max(-LONGEST_STEP), (upper - point[i]).min(LONGEST_STEP)]
        };
        let mut free = free_coordinates(problem, point, gradient);
        let mut step = DVector::zeros(point.len());
        while !free.is_empty() {
            let pushed = gradient + self.curvature * &step;
            let right = DVector::from_fn(free.len(), |r, _| -pushed[free[r]]);
            let Some(found) = self.solve(&free, &right) else { return point.to_vec() };
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
}

/// A trial, a step from a point, bent by the curvature of the residuals along the step; given Jᵀ times what
/// the linearised residuals did not foresee at the trial. `None` if that bends the step too much.
pub(super) fn bent(
    problem: &impl LeastSquares,
    system: &DampedSystem<'_>,
    (trial, step): (&[f64], &DVector<f64>),
    unforeseen: &DVector<f64>,
) -> Option<Vec<f64>> {
    let within = |i: &usize| {
        let [lower, upper] = problem.bounds(*i);
        lower < trial[*i] && trial[*i] < upper
    };
    let free: Vec<usize> = (0..trial.len()).filter(within).collect();
    let bend = system.solve(&free, &DVector::from_fn(free.len(), |r, _| -unforeseen[free[r]]))?;
    let scaled = |r: usize, size: f64| system.scaling[free[r]] * size * size;
    let own = bend.iter().enumerate().map(|(r, size)| scaled(r, *size)).sum::<f64>();
    let whole = free.iter().enumerate().map(|(r, i)| scaled(r, step[*i])).sum::<f64>();
    if own > LONGEST_BEND.powi(2) * whole {
        return None;
    }
    let mut trial = trial.to_vec();
    free.iter().zip(&bend).for_each(|(i, size)| trial[*i] += size);
    problem.clamp(&mut trial);
    Some(trial)
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
pub(in super::super) fn held(
    problem: &impl LeastSquares,
    point: &[f64],
    here: &Linearisation,
) -> Vec<bool> {
    let gradient = here.jacobian.tr_mul(&here.residuals);
    let free = free_coordinates(problem, point, &gradient);
    let on_bound = |i: usize| {
        let [lower, upper] = problem.bounds(i);
        point[i] <= lower || point[i] >= upper
    };
    (0..point.len()).map(|i| !free.contains(&i) || on_bound(i)).collect()
}
