//! Tests of whether residuals are noise, with simulated null distributions.
//!
//! Noise is drawn and projected as the fit projects it, and every statistic is computed from it.
//! The p-values therefore hold in finite samples, for any design, with noise deviations given,
//! estimated or unknown. Of several tests one is often significant by chance. So the smallest
//! p-value is compared with the smallest p-values of the draws (Westfall and Young 1993, ISBN
//! 978-0-471-55761-6), which accounts for the dependence among the tests.

use std::ops::Range;

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::ResidualTest;
use crate::observer::Observer;

use super::null_distribution::NullDistribution;
use super::residual::Residuals;
use super::statistics::{Evaluate, Statistic};

/// Number of draws of noise.
const DRAWS: u64 = 2000;

/// Draws that may show residuals to be no noise, and the p-value below which they do: the tail of so few
/// draws is uncertain by a third in its logarithm, which leaves far less than [`LEVEL`].
const FEW_DRAWS: u64 = 200;
const CERTAIN: f64 = 1e-12;

/// Family-wise error rate: probability that residuals that are noise fail any of the tests.
const LEVEL: f64 = 0.005;

/// Results of the tests.
pub(crate) struct Judgement {
    /// The tests.
    pub tests: Vec<ResidualTest>,
    /// Whether all of them pass.
    pub noise_like: bool,
    /// Value above which the statistic `region` fails.
    pub region_limit: f64,
}

/// Null distributions of all statistics that can be computed.
pub(crate) struct Nulls {
    /// One distribution for each of them, in their order.
    by_test: Vec<NullDistribution>,
    /// p-value below which a test fails.
    limit: f64,
}

impl Nulls {
    /// Simulates the null distributions: draws noise, projects it as the fit does, and computes
    /// every statistic. Once the observer cancels, every further draw is without noise.
    pub fn draw(
        residuals: &Residuals,
        statistics: &[Statistic<'_>],
        seed: u64,
        observer: &dyn Observer,
    ) -> Self {
        Self::of(&drawn(residuals, statistics, (seed, 0..DRAWS), observer))
    }

    /// The same, unless residuals are certainly no noise: a few draws show that they would never
    /// pass.
    pub fn draw_unless_certain(
        residuals: &Residuals,
        statistics: &[Statistic<'_>],
        seed: u64,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let mut values = drawn(residuals, statistics, (seed, 0..FEW_DRAWS), observer);
        let few = Self::of(&values);
        let observed = self::values(statistics, &residuals.values);
        if few.p_values(&observed).any(|p_value| p_value < CERTAIN) {
            return None;
        }
        values.extend(drawn(residuals, statistics, (seed, FEW_DRAWS..DRAWS), observer));
        Some(Self::of(&values))
    }

    /// From the statistics of every draw.
    fn of(drawn: &[Vec<f64>]) -> Self {
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

    /// Tests residuals.
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

/// The statistics of so many draws of noise.
fn drawn(
    residuals: &Residuals,
    statistics: &[Statistic<'_>],
    (seed, draws): (u64, Range<u64>),
    observer: &dyn Observer,
) -> Vec<Vec<f64>> {
    let of = |draw| {
        if observer.cancelled() {
            return vec![0.0; computable(statistics).count()];
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(draw + 1);
        values(statistics, &residuals.left_of(&residuals.law.draw(&mut rng)))
    };
    draws.into_par_iter().map(of).collect()
}

/// The values of all statistics that can be computed.
fn values(statistics: &[Statistic<'_>], residuals: &DVector<f64>) -> Vec<f64> {
    // Answers are written as JSON, which has no infinity.
    computable(statistics).map(|evaluate| evaluate(residuals).clamp(f64::MIN, f64::MAX)).collect()
}

fn computable<'s>(statistics: &'s [Statistic<'_>]) -> impl Iterator<Item = &'s Evaluate<'s>> {
    statistics.iter().filter_map(|statistic| statistic.evaluate.as_ref().ok())
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
