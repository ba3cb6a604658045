//! The distribution of standardised noise. It is normal; where the standard deviations were
//! estimated, from few repeats or from what a model leaves, their own scatter is included.

use nalgebra::DVector;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::estimated_noise::EstimatedLaw;
use super::noise::Weights;
use super::problem::Problem;
use super::variance_law::VarianceLaw;
use super::variance_shrinkage::{Cell, shrunk_variances, sums_of_squares, weighting_variances};

/// Steps of Fisher scoring with which the law of repeats is estimated again from drawn variances.
/// They start from the law itself, which is near.
const REDRAWN_STEPS: usize = 3;

/// The distribution of noise divided by its standard deviation.
///
/// If the standard deviations are given, or unknown and all equal, this is the standard normal
/// distribution. If they were estimated from few repeats, each datum is divided by an estimate that
/// scatters itself. A draw therefore also draws the variances of the repeats, and pools and shrinks
/// them as those of the data. The mean of repeats and their scatter are independent, so both are
/// drawn separately.
#[derive(Debug, Clone)]
pub struct NoiseLaw {
    /// The cells of the scatter, with their shrunk variances; empty if none were estimated.
    scatter: Vec<Vec<Cell>>,
    /// The law towards which these were shrunk.
    scatter_law: Option<VarianceLaw>,
    /// The law from which the standard deviations follow, if it was estimated.
    law: Option<EstimatedLaw>,
    /// Number of real components of every target.
    components: Vec<usize>,
}

impl NoiseLaw {
    pub(super) fn new(problem: &Problem, weights: &Weights) -> Self {
        let mut scatter = weights.scatter.clone();
        let variances = shrunk_variances(&scatter, weights.scatter_law);
        for (cell, variance) in scatter.iter_mut().flatten().zip(variances.into_iter().flatten()) {
            cell.variance = variance;
        }
        let count = |real: bool| if real { 1 } else { 2 };
        let targets = problem.experiments.iter().flat_map(|experiment| &experiment.targets);
        let components = targets.map(|target| count(target.real)).collect();
        let scatter_law = weights.scatter_law;
        Self { scatter, scatter_law, law: weights.law.clone(), components }
    }

    /// Whether the distribution is standard normal.
    pub fn is_normal(&self) -> bool {
        self.scatter.is_empty() && self.law.as_ref().is_none_or(EstimatedLaw::is_of_one_size)
    }

    /// Draws the standardised noise of every real component, in the order of the residuals.
    pub fn draw(&self, rng: &mut ChaCha8Rng) -> DVector<f64> {
        let data = self.components.iter().sum();
        let mut noise = DVector::from_fn(data, |_, _| StandardNormal.sample(rng));
        if let Some(law) = &self.law {
            law.reweighted(&mut noise, &self.components);
        }
        if self.scatter.is_empty() {
            return noise;
        }
        let mut drawn = self.scatter.clone();
        for cell in drawn.iter_mut().flatten().filter(|cell| cell.dof > 0.0) {
            if let Ok(chi2) = ChiSquared::new(cell.dof) {
                cell.variance *= chi2.sample(rng) / cell.dof;
            }
        }
        let again = |law: VarianceLaw| law.refined(&sums_of_squares(&drawn), REDRAWN_STEPS);
        let estimated = weighting_variances(&drawn, self.scatter_law.map(again));
        let truth = self.scatter.iter().flatten();
        let counts = self.components.iter();
        let mut row = 0;
        for ((cell, estimate), count) in truth.zip(estimated.iter().flatten()).zip(counts) {
            for _ in 0..*count {
                noise[row] *= (cell.variance / estimate).sqrt();
                row += 1;
            }
        }
        noise
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, joined, stepped_sine};
    use super::super::noise::weights;
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::measurement::{Complex, Repeat};
    use rand::SeedableRng;

    /// Mean square of many draws if every experiment was repeated this often (0: not at all).
    fn mean_square(repeats: usize) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut experiments = stepped_sine(&axis(ACTUATORS[0]), 5).experiments().to_vec();
        for experiment in &mut experiments {
            let mut deviation = |size: f64| {
                let mut part = || -> f64 { StandardNormal.sample(&mut rng) };
                Complex::new(size * part(), size * part())
            };
            experiment.repeats = (0..repeats)
                .map(|_| Repeat {
                    input: Vec::new(),
                    // Every harmonic has a scatter of its own, so that nothing is pooled.
                    response: experiment
                        .response
                        .iter()
                        .map(|h| deviation(1e-3 * 3.0_f64.powi((h.order % 3) as i32)))
                        .collect(),
                })
                .collect();
        }
        let measurement = joined(experiments);
        let problem = Problem::new(&measurement).unwrap();
        let law = NoiseLaw::new(
            &problem,
            &weights(&measurement, &problem, &IdentifyOptions::default(), None),
        );
        assert_eq!(law.is_normal(), repeats == 0);
        let draws = 200;
        let sum: f64 = (0..draws).map(|_| law.draw(&mut rng).norm_squared()).sum();
        sum / (draws * problem.data()) as f64
    }

    // The mean square of 200 draws of 176 data is 1 with standard deviation √(2/35200) = 0.8 %;
    // allow four.
    // Shrunk variances are scaled so that the mean of 1/s² is 1/σ², but how far they are shrunk is
    // itself estimated.
    #[test]
    fn drawn_noise_has_the_size_that_its_deviations_say() {
        assert!((mean_square(0) - 1.0).abs() < 0.032);
        for repeats in [3, 8] {
            let size = mean_square(repeats);
            assert!((size - 1.0).abs() < 0.1, "{repeats}: {size}");
        }
    }
}
