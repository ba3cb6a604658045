//! Method `cma-es`, a baseline: covariance matrix adaptation evolution strategy, then refinement,
//! without network or closed form.
//!
//! N. Hansen, The CMA Evolution Strategy: A Tutorial, arXiv:1604.00772. The steps follow its Figure
//! 6 and all constants its Table 1, with two exceptions. Points outside the cube are evaluated at
//! the nearest point of the cube, and their cost is multiplied by 1 + ‖x − x_near‖². (The
//! tutorial's appendix B.5 adds a term; a factor needs no weight, and scaling the cost changes
//! nothing.) An infinite cost counts as the worst of its generation.
//!
//! Implemented here because the available crates need other versions of the linear algebra and
//! random number crates, or evaluate the objective outside the budget.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::super::optimiser::{Optimiser, Search, Stop};
use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: false, network: false, search: Some(&CmaEs), refinement: true };

/// Initial σ: 0.3 of the range of each coordinate, as in the tutorial.
const FIRST_STEP: f64 = 0.3;

/// The search has converged if the largest standard deviation of a coordinate is below this share
/// of [`FIRST_STEP`] (the tutorial's TolX, appendix B.3).
const SMALLEST_STEP: f64 = 1e-12;

struct CmaEs;

impl Optimiser for CmaEs {
    fn stage(&self) -> &'static str {
        "evolution"
    }

    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop> {
        let dimension = search.objective.dimension();
        let middle = search.initial.first().cloned().unwrap_or_else(|| vec![0.5; dimension]);
        let constants = Constants::new(dimension);
        let mut state = State::new(&middle);
        loop {
            let (steps, points) = state.sample(&constants, rng);
            let near: Vec<Vec<f64>> =
                points.iter().map(|x| x.iter().map(|x| x.clamp(0.0, 1.0)).collect()).collect();
            let costs = search.evaluate(&near)?;
            search.report(Some(&costs))?;
            let away = |x: &DVector<f64>, near: &Vec<f64>| -> f64 {
                x.iter().zip(near).map(|(x, near)| (x - near).powi(2)).sum()
            };
            let raised = costs.iter().zip(points.iter().zip(&near));
            let ranked: Vec<f64> = raised.map(|(cost, (x, n))| cost * (1.0 + away(x, n))).collect();
            let mut order: Vec<usize> = (0..ranked.len()).collect();
            order.sort_by(|a, b| ranked[*a].total_cmp(&ranked[*b]));
            let best: Vec<&DVector<f64>> = order.iter().map(|i| &steps[*i]).collect();
            state.update(&constants, &best);
            if state.largest_step() < SMALLEST_STEP * FIRST_STEP {
                return Err(Stop::Converged);
            }
        }
    }
}

/// The constants of Table 1 of the tutorial.
struct Constants {
    /// λ, points per generation.
    population: usize,
    /// w₁ … w_λ, the negative ones included.
    weights: Vec<f64>,
    /// μ_eff.
    effective: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// E‖N(0, I)‖.
    normal_length: f64,
}

impl Constants {
    fn new(dimension: usize) -> Self {
        let n = dimension as f64;
        let population = 4 + (3.0 * n.ln()).floor() as usize;
        let parents = population / 2;
        let raw: Vec<f64> = (1..=population)
            .map(|i| (0.5 * (population as f64 + 1.0)).ln() - (i as f64).ln())
            .collect();
        let effective = |weights: &[f64]| {
            weights.iter().sum::<f64>().powi(2) / weights.iter().map(|w| w * w).sum::<f64>()
        };
        let (mu_eff, mu_eff_minus) = (effective(&raw[..parents]), effective(&raw[parents..]));
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let rank_mu = 2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff);
        let c_mu = rank_mu.min(1.0 - c_1);
        let positive: f64 = raw.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = -raw.iter().filter(|w| **w < 0.0).sum::<f64>();
        let alpha = (1.0 + c_1 / c_mu)
            .min(1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0))
            .min((1.0 - c_1 - c_mu) / (n * c_mu));
        let weight = |w: &f64| if *w >= 0.0 { w / positive } else { alpha * w / negative };
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        Self {
            population,
            weights: raw.iter().map(weight).collect(),
            effective: mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_1,
            c_mu,
            normal_length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// The distribution from which points are drawn.
struct State {
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    /// B of C = B D² Bᵀ.
    axes: DMatrix<f64>,
    /// The diagonal of D.
    lengths: DVector<f64>,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    generation: i32,
}

impl State {
    fn new(middle: &[f64]) -> Self {
        let n = middle.len();
        Self {
            mean: DVector::from_column_slice(middle),
            sigma: FIRST_STEP,
            covariance: DMatrix::identity(n, n),
            axes: DMatrix::identity(n, n),
            lengths: DVector::from_element(n, 1.0),
            path_sigma: DVector::zeros(n),
            path_c: DVector::zeros(n),
            generation: 0,
        }
    }

    /// Draws one generation: y = B D z (eq. 39) and x = m + σ y (eq. 40).
    fn sample(
        &self,
        constants: &Constants,
        rng: &mut ChaCha8Rng,
    ) -> (Vec<DVector<f64>>, Vec<DVector<f64>>) {
        let draw = |_| {
            let z = DVector::from_fn(self.mean.len(), |_, _| StandardNormal.sample(rng));
            let y: DVector<f64> = &self.axes * self.lengths.component_mul(&z);
            let x = &self.mean + self.sigma * &y;
            (y, x)
        };
        (0..constants.population).map(draw).unzip()
    }

    /// Equations 41 to 47; `best` are the steps y, the best first.
    fn update(&mut self, constants: &Constants, best: &[&DVector<f64>]) {
        let Constants { weights, effective, c_sigma, d_sigma, c_c, c_1, c_mu, .. } = constants;
        let n = self.mean.len() as f64;
        self.generation += 1;
        let parents = best.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
        let step: DVector<f64> = parents.map(|(y, weight)| *weight * *y).sum();
        self.mean += self.sigma * &step;
        let whitened = self.whiten(&step);
        self.path_sigma = (1.0 - c_sigma) * &self.path_sigma
            + (c_sigma * (2.0 - c_sigma) * effective).sqrt() * whitened;
        let length = self.path_sigma.norm();
        let begun = 1.0 - (1.0 - c_sigma).powi(2 * self.generation);
        let short = length / begun.sqrt() < (1.4 + 2.0 / (n + 1.0)) * constants.normal_length;
        let h_sigma = if short { 1.0 } else { 0.0 };
        self.path_c =
            (1.0 - c_c) * &self.path_c + h_sigma * (c_c * (2.0 - c_c) * effective).sqrt() * &step;
        let delta = (1.0 - h_sigma) * c_c * (2.0 - c_c);
        let all: f64 = weights.iter().sum();
        let mut covariance = (1.0 + c_1 * delta - c_1 - c_mu * all) * &self.covariance
            + *c_1 * &self.path_c * self.path_c.transpose();
        for (y, weight) in best.iter().zip(weights) {
            let scaled = match *weight >= 0.0 {
                true => *weight,
                false => weight * n / self.whiten(y).norm_squared().max(f64::MIN_POSITIVE),
            };
            covariance += c_mu * scaled * *y * y.transpose();
        }
        self.sigma *= (c_sigma / d_sigma * (length / constants.normal_length - 1.0)).exp();
        self.decompose(covariance);
    }

    fn decompose(&mut self, covariance: DMatrix<f64>) {
        self.covariance = 0.5 * (&covariance + covariance.transpose());
        let SymmetricEigen { eigenvectors, eigenvalues } =
            self.covariance.clone().symmetric_eigen();
        self.axes = eigenvectors;
        // Rounding can make the smallest eigenvalue negative.
        self.lengths = eigenvalues.map(|value| value.max(f64::MIN_POSITIVE).sqrt());
    }

    /// C^(−1/2) y.
    fn whiten(&self, y: &DVector<f64>) -> DVector<f64> {
        let along = self.axes.tr_mul(y).component_div(&self.lengths);
        &self.axes * along
    }

    /// Largest standard deviation of a coordinate.
    fn largest_step(&self) -> f64 {
        self.sigma * self.covariance.diagonal().max().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_are_those_of_the_tutorial() {
        for n in 1..12 {
            let constants = Constants::new(n);
            let positive: f64 = constants.weights.iter().filter(|w| **w > 0.0).sum();
            assert!((positive - 1.0).abs() < 1e-12, "{n}");
            assert!(constants.c_1 + constants.c_mu <= 1.0 && constants.c_sigma < 1.0);
            // The decay factor of C, 1 − c₁ − c_μ Σ w, stays positive.
            let all: f64 = constants.weights.iter().sum();
            assert!(1.0 - constants.c_1 - constants.c_mu * all > 0.0);
        }
        // λ = 4 + ⌊3 ln 4⌋ = 8; w₁ ∝ ln 4.5, and μ_eff is that of four logarithmic weights.
        let four = Constants::new(4);
        assert_eq!(four.population, 8);
        assert!((four.effective - 2.6).abs() < 0.05, "{}", four.effective);
    }
}
