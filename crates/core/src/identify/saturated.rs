//! Fits with as many parameters as there are data.
//!
//! The best model of such a fit goes through all data, whatever their noise. So whether a minimum is
//! the best one can be seen, which is not so of any other fit, and where it is not, others are sought
//! from random starts. A simulation of so few data costs next to nothing.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::objective::Misfit;
use super::problem::Prepared;

/// Most random starts (tuned).
pub(super) const STARTS: usize = 100;

/// Share of the data's sum of squares that a model which goes through all data leaves, at most: that of
/// data of three digits.
const LEFT: f64 = 1e-6;

/// Whether a fit has as many parameters as there are data, and a minimum of this cost is not the best.
pub(super) fn misses(misfit: &Misfit<'_>, cost: f64) -> bool {
    let problem = misfit.problem;
    let parameters = misfit.coordinates.len() + misfit.weights.eliminated.len();
    problem.data() <= parameters && cost > LEFT * size(misfit)
}

/// The sum of squares of the data, each relative to its noise.
fn size(misfit: &Misfit<'_>) -> f64 {
    let of_experiment = |(e, experiment): (usize, &Prepared)| -> f64 {
        let weighted = experiment.targets.iter().zip(&misfit.weights.sigma[e]);
        weighted.map(|(target, sigma)| (target.value / sigma).norm_sqr()).sum()
    };
    misfit.problem.experiments.iter().enumerate().map(of_experiment).sum()
}

/// A start anywhere in the search ranges.
pub(super) fn start(misfit: &Misfit<'_>, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let cube: Vec<f64> = (1..misfit.coordinates.len()).map(|_| rng.random()).collect();
    let mut point = misfit.coordinates.within_search(&cube);
    misfit.solve_for_constant(&mut point);
    point
}
