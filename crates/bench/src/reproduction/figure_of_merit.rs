//! Error measures and success criteria of an answer, and statistics over seeds.

use servoscope_core::measurement::Complex;

use super::runs::{Outcome, Run};
use super::system::System;

/// Largest relative error that counts as success on noise-free data: 0.004 %, the best value in the
/// paper for the pole of G1.
pub(super) const EXACT_TOLERANCE: f64 = 4e-5;

/// Largest deviation of every parameter, in standard deviations, that counts as success on noisy
/// data. By chance one parameter in 16 000 is further off.
pub(super) const SIGMAS: f64 = 4.0;

/// Largest relative deviation of the rows of a table from their computed targets.
pub fn largest_error(system: System, rows: &[Complex]) -> f64 {
    let errors = rows.iter().zip(system.targets()).map(|(row, t)| (row - t).norm() / t.norm());
    errors.fold(0.0, f64::max)
}

/// The median; for an even number of values the mean of the middle two, for none NaN.
pub fn median(values: &[f64]) -> f64 {
    let sorted = sorted(values);
    match sorted.len() {
        0 => f64::NAN,
        n => 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
    }
}

/// The 90th percentile, defined such that a tenth of all values are larger: the third largest of
/// 20.
pub fn percentile_90(values: &[f64]) -> f64 {
    let sorted = sorted(values);
    sorted
        .get((9 * sorted.len()) / 10 - usize::from(sorted.len() >= 10))
        .copied()
        .unwrap_or(f64::NAN)
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// Median of the values of a row (of real and imaginary part separately), and the value farthest
/// from the target.
pub(super) fn median_and_worst(values: &[Complex], target: Complex) -> Option<(Complex, Complex)> {
    let part = |part: fn(&Complex) -> f64| median(&values.iter().map(part).collect::<Vec<_>>());
    let middle = Complex::new(part(|v| v.re), part(|v| v.im));
    let distance = |value: &Complex| (value - target).norm();
    let worst = values.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    Some((middle, *worst))
}

/// Selects one of the outcomes of a run.
pub type Which = fn(&Run) -> Option<&Outcome>;

/// Selects the outcome of the search, without refinement.
pub(super) const ALONE: Which = |run| run.alone.as_ref();

/// Selects the outcome of the refinement.
pub(super) const REFINED: Which = |run| run.refined.as_ref();

/// Selects the final outcome: of the refinement, or of the search if there is no refinement.
pub const ANSWER: Which = |run| run.refined.as_ref().or(run.alone.as_ref());

/// Collects one property of the selected outcome of every run that has one.
pub fn each<T>(runs: &[&Run], which: Which, of: impl Fn(&Outcome) -> T) -> Vec<T> {
    runs.iter().filter_map(|run| which(run)).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_the_farthest_from_the_target_on_either_side() {
        let values = [0.9, 1.0, 1.02].map(|x| Complex::new(x, 0.0));
        let (median, worst) = median_and_worst(&values, Complex::new(1.0, 0.0)).unwrap();
        assert_eq!((median.re, worst.re), (1.0, 0.9));
        assert!(median_and_worst(&[], Complex::new(1.0, 0.0)).is_none());
    }

    #[test]
    fn the_ninetieth_percentile_of_twenty_is_the_third_largest() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!((percentile_90(&values), median(&values)), (18.0, 10.5));
    }
}
