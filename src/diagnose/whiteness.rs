//! Whether residuals are noise: every statistic against draws of noise.
//!
//! Noise is drawn, projected as the fit projects it, and every statistic taken
//! of it; what the data's statistics are compared with is thus right in finite
//! samples, at any design, with scales given, estimated or unknown. A family of
//! tests is right by chance too often: the smallest of their p-values is
//! compared with the smallest of each draw (Westfall and Young 1993, ISBN
//! 978-0-471-55761-6), which knows how the statistics depend on each other.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::ResidualTest;

use super::residual::Residuals;
use super::statistics::Statistic;

/// Draws of noise.
const DRAWS: u64 = 2000;

/// Probability that residuals that are noise are called something else.
pub(super) const LEVEL: f64 = 0.005;

/// Share of the draws from which the tail is extrapolated.
const TAIL: f64 = 0.05;

/// What the tests come to.
pub(super) struct Judgement {
    /// The tests.
    pub tests: Vec<ResidualTest>,
    /// Whether all pass.
    pub noise_like: bool,
    /// Probability of a smallest p-value at least as small, if all were noise.
    pub p_value: f64,
    /// What `region` must exceed to fail.
    pub region_limit: f64,
}

/// Distribution of one statistic under the null hypothesis.
struct Null {
    /// Drawn values, ascending.
    sorted: Vec<f64>,
    /// Where the tail begins, and the mean by which it is exceeded beyond.
    tail: (f64, f64),
}

impl Null {
    fn new(mut drawn: Vec<f64>) -> Self {
        drawn.sort_by(f64::total_cmp);
        let begin = ((1.0 - TAIL) * drawn.len() as f64) as usize;
        let start = drawn[begin.min(drawn.len() - 1)];
        let beyond = &drawn[begin.min(drawn.len() - 1)..];
        let mean = beyond.iter().map(|value| value - start).sum::<f64>() / beyond.len() as f64;
        Self { sorted: drawn, tail: (start, mean) }
    }

    /// Probability of a value at least as large: counted, and beyond the start of
    /// the tail extrapolated by the exponential that every χ²-like law ends in.
    fn p_value(&self, value: f64) -> f64 {
        let (start, mean) = self.tail;
        if value > start && mean > 0.0 {
            return TAIL * (-(value - start) / mean).exp();
        }
        let below = self.sorted.partition_point(|drawn| *drawn < value);
        ((self.sorted.len() - below) as f64 + 0.5) / (self.sorted.len() as f64 + 1.0)
    }

    /// The value that has this p-value, a small one.
    fn limit(&self, p_value: f64) -> f64 {
        let (start, mean) = self.tail;
        start + mean * (TAIL / p_value).ln().max(0.0)
    }
}

/// Judges residuals.
pub(super) fn judge(residuals: &Residuals, statistics: &[Statistic<'_>], seed: u64) -> Judgement {
    let available: Vec<_> =
        statistics.iter().filter_map(|s| s.evaluate.as_ref().ok().map(|e| (s.name, e))).collect();
    let drawn: Vec<Vec<f64>> = (0..DRAWS)
        .into_par_iter()
        .map(|draw| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(draw + 1);
            let left = residuals.left_of(&residuals.law.draw(&mut rng));
            available.iter().map(|(_, evaluate)| evaluate(&left)).collect()
        })
        .collect();
    let nulls: Vec<Null> = (0..available.len())
        .map(|test| Null::new(drawn.iter().map(|values| values[test]).collect()))
        .collect();
    let smallest = |values: &[f64]| {
        let p_values = nulls.iter().zip(values).map(|(null, value)| null.p_value(*value));
        p_values.fold(1.0, f64::min)
    };
    let mut minima: Vec<f64> = drawn.iter().map(|values| smallest(values)).collect();
    minima.sort_by(f64::total_cmp);
    let limit = minima[(LEVEL * minima.len() as f64) as usize];
    let observed: Vec<f64> =
        available.iter().map(|(_, evaluate)| evaluate(&residuals.values)).collect();
    let at_most = minima.partition_point(|minimum| *minimum <= smallest(&observed));
    let mut next = observed.iter().zip(&nulls);
    let tests: Vec<ResidualTest> = statistics
        .iter()
        .map(|statistic| match &statistic.evaluate {
            Err(reason) => untested(statistic.name, reason),
            Ok(_) => {
                let (value, null) = next.next().expect("one value a statistic");
                let p_value = null.p_value(*value);
                let passed = p_value >= limit;
                let explanation = if passed { statistic.small } else { statistic.large };
                ResidualTest {
                    name: statistic.name.into(),
                    statistic: *value,
                    p_value: Some(p_value),
                    passed,
                    explanation: explanation.into(),
                }
            }
        })
        .collect();
    let region = available.iter().position(|(name, _)| *name == "region");
    Judgement {
        noise_like: tests.iter().all(|test| test.passed),
        tests,
        p_value: (at_most as f64 + 1.0) / (minima.len() as f64 + 1.0),
        region_limit: region.map_or(f64::INFINITY, |index| nulls[index].limit(limit)),
    }
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
