//! The null distribution of a statistic, from simulated draws, with an extrapolated tail.
//!
//! The tail of any χ²-like distribution is close to exponential, so small p-values come from an
//! exponential fitted to the largest draws.

/// Share of the draws, the largest, to which the exponential is fitted.
const TAIL_SHARE: f64 = 0.05;

/// Distribution of one statistic under the null hypothesis.
#[derive(Clone)]
pub(crate) struct NullDistribution {
    /// Drawn values, ascending.
    sorted: Vec<f64>,
    /// Where the tail begins, and by how much its draws exceed that on average.
    tail: (f64, f64),
}

impl NullDistribution {
    /// From drawn values, of which there must be at least one.
    pub fn new(mut drawn: Vec<f64>) -> Self {
        drawn.sort_by(f64::total_cmp);
        let begin = ((1.0 - TAIL_SHARE) * drawn.len() as f64) as usize;
        let start = drawn[begin.min(drawn.len() - 1)];
        let beyond = &drawn[begin.min(drawn.len() - 1)..];
        let mean = beyond.iter().map(|value| value - start).sum::<f64>() / beyond.len() as f64;
        Self { sorted: drawn, tail: (start, mean) }
    }

    /// Probability of a value at least as large: the share of such draws; in the tail, the
    /// exponential.
    pub fn p_value(&self, value: f64) -> f64 {
        let (start, mean) = self.tail;
        if value > start && mean > 0.0 {
            return TAIL_SHARE * (-(value - start) / mean).exp();
        }
        let below = self.sorted.partition_point(|drawn| *drawn < value);
        ((self.sorted.len() - below) as f64 + 0.5) / (self.sorted.len() as f64 + 1.0)
    }

    /// The value that has this p-value, which must not be above [`TAIL_SHARE`].
    pub fn limit(&self, p_value: f64) -> f64 {
        let (start, mean) = self.tail;
        start + mean * (TAIL_SHARE / p_value).ln().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{ChiSquared, Distribution};
    use statrs::distribution::ContinuousCDF;

    use super::*;

    #[test]
    fn the_limit_has_the_p_value_it_was_asked_for() {
        let null = NullDistribution::new((0..600).map(f64::from).collect());
        for p_value in [0.04, 1e-2, 1e-5] {
            assert!((null.p_value(null.limit(p_value)) / p_value - 1.0).abs() < 1e-9);
        }
        assert!((null.p_value(300.0) - 0.5).abs() < 0.01);
    }

    // Of 600 draws 30 lie in the tail, so its scale (2 here) is known to 18 %. The limit at 1e-4
    // lies 6.2 scales beyond its start: a standard deviation of 1.1 scales, 2.3 of 18.4.
    #[test]
    fn the_tail_of_a_chi_squared_law_is_extrapolated() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let law = ChiSquared::new(2.0).unwrap();
        let null = NullDistribution::new((0..600).map(|_| law.sample(&mut rng)).collect());
        let exact = statrs::distribution::ChiSquared::new(2.0).unwrap().inverse_cdf(1.0 - 1e-4);
        assert!((null.limit(1e-4) - exact).abs() < 0.2 * exact, "{}", null.limit(1e-4));
    }
}
