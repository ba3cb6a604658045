//! The noise of data of which nothing is stated: its law is estimated from the scatter of what a
//! model leaves.
//!
//! Weights follow from the law up to a common factor, which stays unknown: it is estimated from the
//! residuals of each model.

use nalgebra::DVector;

use crate::effects::ActiveEffect;
use crate::measurement::Complex;
use crate::plant::Plant;
use crate::simulate::Counts;

use super::local_scatter::LocalScatter;
use super::problem::Problem;
use super::variance_law::VarianceLaw;

/// Scatter below this share of the largest response is rounding in the upload and the simulation,
/// and tells no noise.
const ROUNDING_SHARE: f64 = 1e-6;

/// Steps of Fisher scoring with which the law is estimated again from drawn noise. They start from
/// the law itself, which is near.
const REDRAWN_STEPS: usize = 3;

/// Number of differences from neighbours that tell as much as one that shares no residual with
/// others: 1 + 2·(4/9 + 1/36). Second differences in equal steps have correlations of −2/3 and 1/6
/// with the next and the second next; the correlations of their squares are the squares of these.
const SHARED: f64 = 1.94;

/// A law, and the data that it was estimated from.
#[derive(Debug, Clone)]
pub(super) struct EstimatedLaw {
    /// The law, in scale.
    pub law: VarianceLaw,
    /// 95 % intervals of its parts α and β, in scale.
    pub intervals: [[f64; 2]; 2],
    scatter: LocalScatter,
    /// |Ŷ| of every datum, in scale.
    sizes: Vec<f64>,
}

impl EstimatedLaw {
    /// The law of the noise about a model, in scale; without a proportional part if the data shows
    /// none. `None` if no datum has neighbours, or if there is nothing but rounding.
    pub fn of(problem: &Problem, plant: &Plant, effects: &[ActiveEffect]) -> Option<Self> {
        let scatter = LocalScatter::of(problem);
        let (mut sizes, mut residuals) = (Vec::new(), Vec::new());
        for experiment in &problem.experiments {
            let response = experiment.respond(Counts::FromRest, plant, effects);
            for target in &experiment.targets {
                // Where the model has no response, the measured one says how large it is.
                let simulated = response
                    .as_ref()
                    .map_or(target.value, |velocity| velocity[target.order] * target.per_velocity);
                sizes.push(simulated.norm());
                residuals.push(target.value - simulated);
            }
        }
        let sums = scatter.sums(&residuals, &sizes);
        let law = VarianceLaw::fit(&sums)?;
        let this = Self { law, intervals: law.intervals(&sums, SHARED), scatter, sizes };
        let most = this.stds(law).into_iter().fold(0.0, f64::max);
        (most > ROUNDING_SHARE * this.largest()).then_some(this)
    }

    /// The same for a part of the data: whether each datum is kept.
    pub fn only(&self, kept: &[bool]) -> Self {
        let sizes = self.sizes.iter().zip(kept).filter(|(_, kept)| **kept).map(|(size, _)| *size);
        Self { scatter: self.scatter.only(kept), sizes: sizes.collect(), ..*self }
    }

    /// Whether all data have the same standard deviation.
    pub fn is_of_one_size(&self) -> bool {
        self.law.proportional <= 0.0
    }

    fn largest(&self) -> f64 {
        self.sizes.iter().copied().fold(0.0, f64::max)
    }

    /// Standard deviation of every datum by a law, in scale.
    fn stds(&self, law: VarianceLaw) -> Vec<f64> {
        let largest = self.largest();
        self.sizes.iter().map(|size| law.std(*size, largest)).collect()
    }

    /// Standard deviation of every datum, by experiment and target, divided by their geometric
    /// mean. Sums of squares under different laws then compare as the likelihoods do.
    pub fn sigma(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let stds = self.stds(self.law);
        let targets = || problem.experiments.iter().flat_map(|e| &e.targets);
        let parts = |real: bool| if real { 1.0 } else { 2.0 };
        let (mut logarithms, mut count) = (0.0, 0.0);
        for (target, std) in targets().zip(&stds) {
            logarithms += parts(target.real) * std.ln();
            count += parts(target.real);
        }
        let mean = (logarithms / count).exp();
        let mut stds = stds.into_iter().map(|std| std / mean);
        let of_experiment = |targets: usize| -> Vec<f64> { stds.by_ref().take(targets).collect() };
        problem.experiments.iter().map(|e| e.targets.len()).map(of_experiment).collect()
    }

    /// Divides standardised noise by what its own scatter makes of its standard deviations: noise
    /// under estimated weights. `components` are the numbers of real components of every datum.
    pub fn reweighted(&self, noise: &mut DVector<f64>, components: &[usize]) {
        if self.is_of_one_size() {
            return;
        }
        let stds = self.stds(self.law);
        let mut row = 0;
        let residuals: Vec<Complex> = components
            .iter()
            .zip(&stds)
            .map(|(count, std)| {
                let im = if *count == 2 { noise[row + 1] } else { 0.0 };
                let value = Complex::new(noise[row], im) * *std;
                row += count;
                value
            })
            .collect();
        let sums = self.scatter.sums(&residuals, &self.sizes);
        let found = self.stds(self.law.refined(&sums, REDRAWN_STEPS));
        let mut row = 0;
        for ((count, std), found) in components.iter().zip(&stds).zip(&found) {
            for _ in 0..*count {
                noise[row] *= std / found;
                row += 1;
            }
        }
    }
}
