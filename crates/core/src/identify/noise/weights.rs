//! The standard deviations that weight the data, and where they come from.

use crate::answers::NoiseSource;
use crate::identify::correlated::{self, Correlation};
use crate::identify::direction::{self, Direction};
use crate::identify::eliminated;
use crate::identify::estimated_noise::EstimatedLaw;
use crate::identify::problem::Problem;
use crate::identify::variance_law::VarianceLaw;
use crate::identify::variance_shrinkage::Cell;

/// Weights whose standard deviations differ by less than this (rms of their logarithms) are the
/// same: each part of a law is estimated from some hundred data to about a tenth.
const SAME_WEIGHTS: f64 = 0.1;

/// Standard deviation of every target, in scale.
#[derive(Debug, Clone)]
pub(in super::super) struct Weights {
    /// Standard deviation of re and of im each, by experiment and target.
    pub sigma: Vec<Vec<f64>>,
    /// Where the standard deviations come from.
    pub source: NoiseSource,
    /// Degrees of freedom of the estimated noise scale; infinite if the scale is given.
    pub scale_dof: f64,
    /// Whether they depend on the model, which they do if the input scatters, or if they are
    /// estimated from what the model leaves.
    pub depend_on_model: bool,
    /// The law from which they follow, if they are estimated from what a model leaves.
    pub law: Option<EstimatedLaw>,
    /// The law towards which the variances of repeats were shrunk.
    pub scatter_law: Option<VarianceLaw>,
    /// The variances they were estimated from; empty if they were not estimated.
    pub scatter: Vec<Vec<Cell>>,
    /// What is eliminated from residuals with these standard deviations.
    pub eliminated: Vec<Direction>,
    /// How the noise is correlated, by experiment; empty if it is not.
    pub correlations: Vec<Option<Correlation>>,
    /// The directions along which that makes the noise larger than `sigma` says.
    pub noisier: Vec<Direction>,
}

impl Weights {
    /// The same weights of a problem of which other numbers are not known, or with other deviations.
    pub fn eliminating(self, problem: &Problem) -> Self {
        Self {
            eliminated: eliminated::directions(problem, &self.sigma),
            noisier: correlated::directions(problem, &self.correlations),
            ..self
        }
    }

    /// Takes from residuals, or their derivatives, in units of `sigma` what is eliminated, and scales
    /// them along the directions in which the noise is larger.
    pub fn reduce(&self, rows: &mut [f64]) {
        direction::reduce(&self.noisier, rows);
        direction::reduce(&self.eliminated, rows);
    }

    /// Whether these weigh the data alike: the ratios of their standard deviations differ by no
    /// more than the law can be estimated to.
    pub fn resemble(&self, others: &Self) -> bool {
        let pairs = || self.sigma.iter().flatten().zip(others.sigma.iter().flatten());
        let count = pairs().count().max(1) as f64;
        let square = |(own, other): (&f64, &f64)| (own / other).ln().powi(2);
        (pairs().map(square).sum::<f64>() / count).sqrt() <= SAME_WEIGHTS
    }

    /// Whether the size of the noise is known.
    pub fn known(&self) -> bool {
        self.source != NoiseSource::Estimated
    }
}
