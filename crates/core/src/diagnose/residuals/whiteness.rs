//! Whether residuals are noise: every statistic is compared with its null distribution.
//!
//! Noise is drawn, projected as the fit projects it, and every statistic taken of it. The comparison
//! is therefore right in finite samples, for any design, with deviations given, estimated or unknown.
//! One of several tests is significant by chance too often, so that the smallest of their p-values is
//! compared with the smallest of each draw (Westfall and Young 1993, ISBN 978-0-471-55761-6), which
//! accounts for the dependence among the tests.

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::ResidualTest;

use super::null_distribution::NullDistribution;
use super::residual::Residuals;
use super::statistics::Statistic;

/// Draws of noise.
const DRAWS: u64 = 2000;

/// Probability that residuals that are noise are called something else.
const LEVEL: f64 = 0.005;

/// What the tests come to.
pub(crate) struct Judgement {
    /// The tests.
    pub tests: Vec<ResidualTest>,
    /// Whether all pass.
    pub noise_like: bool,
    /// What `region` must exceed to fail.
    pub region_limit: f64,
}

/// Distributions of all statistics under the null hypothesis.
pub(crate) struct Nulls {
    /// In the order of the statistics that there are.
    by_test: Vec<NullDistribution>,
    /// p-value below which a test fails.
    limit: f64,
}

impl Nulls {
    /// Draws noise as the fit would leave it and takes every statistic of it.
    pub fn draw(residuals: &Residuals, statistics: &[Statistic<'_>], seed: u64) -> Self {
        let drawn: Vec<Vec<f64>> = (0..DRAWS)
            .into_par_iter()
            .map(|draw| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(draw + 1);
                values(statistics, &residuals.left_of(&residuals.law.draw(&mut rng)))
            })
            .collect();
        let tests = drawn.first().map_or(0, Vec::len);
        let column = |test: usize| drawn.iter().map(|values| values[test]).collect();
        let mut nulls = Self {
            by_test: (0..tests).map(|test| NullDistribution::new(column(test))).collect(),
            limit: 0.0,
        };
        let smallest = |values: &Vec<f64>| nulls.p_values(values).fold(1.0, f64::min);
        let mut minima: Vec<f64> = drawn.iter().map(smallest).collect();
        minima.sort_by(f64::total_cmp);
        nulls.limit = minima[(LEVEL * minima.len() as f64) as usize];
        nulls
    }

    /// Judges residuals.
    pub fn judge(&self, statistics: &[Statistic<'_>], residuals: &DVector<f64>) -> Judgement {
        let observed = values(statistics, residuals);
        let mut next = observed.iter().zip(self.p_values(&observed));
        let mut judged = |statistic: &Statistic<'_>| {
            if let Err(reason) = statistic.evaluate {
                return untested(statistic.name, reason);
            }
            let (value, p_value) = next.next().expect("one value a statistic");
            let passed = p_value >= self.limit;
            ResidualTest {
                name: statistic.name.into(),
                statistic: *value,
                p_value: Some(p_value),
                passed,
                explanation: if passed { statistic.small } else { statistic.large }.into(),
            }
        };
        let tests: Vec<ResidualTest> = statistics.iter().map(&mut judged).collect();
        let available = statistics.iter().filter(|statistic| statistic.evaluate.is_ok());
        let region = available.zip(&self.by_test).find(|(s, _)| s.name == "region");
        Judgement {
            noise_like: tests.iter().all(|test| test.passed),
            tests,
            region_limit: region.map_or(f64::INFINITY, |(_, null)| null.limit(self.limit)),
        }
    }

    fn p_values(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        self.by_test.iter().zip(values).map(|(null, value)| null.p_value(*value))
    }
}

/// Every statistic that there is.
fn values(statistics: &[Statistic<'_>], residuals: &DVector<f64>) -> Vec<f64> {
    let evaluates = statistics.iter().filter_map(|statistic| statistic.evaluate.as_ref().ok());
    // An answer is written as JSON, which knows no infinity.
    evaluates.map(|evaluate| evaluate(residuals).clamp(f64::MIN, f64::MAX)).collect()
}

fn untested(name: &str, reason: &str) -> ResidualTest {
    ResidualTest {
        name: name.into(),
        statistic: 0.0,
        p_value: None,
        passed: true,
        explanation: format!("not tested: {reason}"),
    }
}
