//! Rms or peak-to-peak values that are called peak values, told by the means.
//!
//! An axis of another gain has the same harmonics, all multiplied by one factor. A mean is no amplitude
//! and keeps its value. So where harmonics times f are peak values, the means are f times those of the
//! axis that fits the harmonics, and change with its parameters f times as much. To first order this
//! gives what is left with each factor, without a refit.
//!
//! Both factors are known numbers, so that nothing is estimated but the model. In a sound measurement
//! the likelihood ratio of a wrong hypothesis has the mean 1, and exceeds x with a probability of 1/x at
//! most (A. Markov's inequality).

use std::f64::consts::{LN_2, SQRT_2};

use nalgebra::DVector;

use crate::diagnose::residuals::layout::Cell;
use crate::diagnose::residuals::subspace::Subspace;

use super::candidates::{FAULT_COST, column};
use super::projection::dense;

/// Factors from rms and from peak-to-peak values to peak values.
const FACTORS: [f64; 2] = [SQRT_2, 0.5];

/// −2 ln of the prior probability of one of the factors.
pub(super) const PRICE: f64 = FAULT_COST + 2.0 * LN_2;

/// One of the factors, and what is left with it.
pub(super) struct Convention {
    /// Peak value over what was measured.
    pub factor: f64,
    /// By how much it lowers Σr².
    pub gain: f64,
    /// What the fit absorbs, and what it leaves, in standard deviations.
    pub fitted: Subspace,
    pub left: DVector<f64>,
}

/// By how much a factor has to lower χ², so that chance finds one of them with at most this
/// probability.
pub(super) fn limit(probability: f64) -> f64 {
    -2.0 * (probability / FACTORS.len() as f64).ln()
}

/// The factor with which less is left; `None` without means, and of means alone. `left` is what a fit
/// leaves outside of what it absorbs.
pub(super) fn best(cells: &[Cell], fitted: &Subspace, left: &DVector<f64>) -> Option<Convention> {
    let means: Vec<&Cell> = cells.iter().filter(|cell| cell.order == 0).collect();
    if means.is_empty() || means.len() == cells.len() {
        return None;
    }
    let simulated = dense(&column(&means, |cell| cell.simulated), left.len());
    let with = |factor: f64| {
        let mut stretch = DVector::from_element(left.len(), 1.0);
        means.iter().for_each(|mean| stretch[mean.rows.0] = factor);
        let fitted = fitted.stretched(&stretch);
        let now = fitted.complement(&(left + (1.0 - factor) * &simulated));
        let gain = left.norm_squared() - now.norm_squared();
        Convention { factor, gain, fitted, left: now }
    };
    FACTORS.into_iter().map(with).max_by(|a, b| a.gain.total_cmp(&b.gain))
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::measurement::Complex;

    const EXPERIMENTS: usize = 40;

    fn cell(experiment: usize, order: usize, rows: (usize, Option<usize>), re: f64) -> Cell {
        Cell {
            rows,
            magnitude: 0,
            band: 0,
            harmonic: order,
            frequency_hz: 1.0,
            input_magnitude: 1.0,
            experiment,
            order,
            excited: order == 1,
            run: None,
            measured: Complex::ZERO,
            simulated: Complex::new(re, 0.0),
            std: 1.0,
        }
    }

    /// What [`best`] finds where the mean and the second harmonic of every experiment are this many
    /// standard deviations large and proportional to one parameter, and harmonics are multiplied by a factor.
    fn found(size: f64, multiplied: f64, seed: u64) -> Convention {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let shape = |row: usize| if row % 3 == 2 { 0.5 } else { 1.0 };
        let exact =
            |row: usize| size * shape(row) * if row.is_multiple_of(3) { 1.0 } else { multiplied };
        let measured = DVector::from_fn(3 * EXPERIMENTS, |row, _| {
            let noise: f64 = StandardNormal.sample(rng);
            exact(row) + noise
        });
        let column = DVector::from_fn(3 * EXPERIMENTS, |row, _| shape(row));
        let simulated = &column * (column.dot(&measured) / column.norm_squared());
        let fitted = Subspace::of(&DMatrix::from_columns(&[column]));
        let cells: Vec<Cell> = (0..EXPERIMENTS)
            .flat_map(|i| {
                let (mean, re) = (3 * i, 3 * i + 1);
                let second = cell(i, 2, (re, Some(re + 1)), simulated[re]);
                [cell(i, 0, (mean, None), simulated[mean]), second]
            })
            .collect();
        best(&cells, &fitted, &(measured - simulated)).unwrap()
    }

    #[test]
    fn the_factor_from_harmonics_to_means_tells_the_convention() {
        for (multiplied, factor) in [(0.5_f64.sqrt(), SQRT_2), (2.0, 0.5)] {
            let found = found(10.0, multiplied, 1);
            assert_eq!(found.factor, factor);
            // One standard deviation in each of 120 numbers, less one parameter: 119 ± 15.
            assert!((74.0..164.0).contains(&found.left.norm_squared()), "{}", found.gain);
            // Without noise 189 for rms values, with a standard deviation of 27, and more for the others.
            assert!(found.gain > 100.0, "{}", found.gain);
        }
    }

    // Of means that are noise the measured ones would be their own best predictors.
    #[test]
    fn nothing_is_found_in_a_sound_measurement_however_small_its_means() {
        for size in [0.0, 0.3, 1.0, 5.0] {
            for seed in 0..50 {
                // Any of 200 exceeds this with a probability of a fiftieth at most.
                assert!(found(size, 1.0, seed).gain < limit(1e-4), "{size} {seed}");
            }
        }
    }

    #[test]
    fn the_limit_is_what_the_likelihood_ratio_of_either_factor_seldom_exceeds() {
        // exp(−x/2) twice is the probability.
        assert!((2.0 * (-0.5 * limit(1e-3)).exp() / 1e-3 - 1.0).abs() < 1e-12);
    }
}
