//! The null distribution of a statistic: what it comes to where the residuals are noise.

/// Share of the draws from which the tail is extrapolated.
const TAIL: f64 = 0.05;

/// Distribution of one statistic under the null hypothesis.
#[derive(Clone)]
pub(crate) struct NullDistribution {
    /// Drawn values, ascending.
    sorted: Vec<f64>,
    /// Where the tail begins, and the mean by which it is exceeded beyond.
    tail: (f64, f64),
}

impl NullDistribution {
    /// From drawn values, at least one.
    pub fn new(mut drawn: Vec<f64>) -> Self {
        drawn.sort_by(f64::total_cmp);
        let begin = ((1.0 - TAIL) * drawn.len() as f64) as usize;
        let start = drawn[begin.min(drawn.len() - 1)];
        let beyond = &drawn[begin.min(drawn.len() - 1)..];
        let mean = beyond.iter().map(|value| value - start).sum::<f64>() / beyond.len() as f64;
        Self { sorted: drawn, tail: (start, mean) }
    }

    /// Probability of a value at least as large: counted, and beyond the start of
    /// the tail extrapolated by the exponential that every χ²-like law ends in.
    pub fn p_value(&self, value: f64) -> f64 {
        let (start, mean) = self.tail;
        if value > start && mean > 0.0 {
            return TAIL * (-(value - start) / mean).exp();
        }
        let below = self.sorted.partition_point(|drawn| *drawn < value);
        ((self.sorted.len() - below) as f64 + 0.5) / (self.sorted.len() as f64 + 1.0)
    }

    /// The value that has this p-value, a small one.
    pub fn limit(&self, p_value: f64) -> f64 {
        let (start, mean) = self.tail;
        start + mean * (TAIL / p_value).ln().max(0.0)
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
    fn a_limit_is_where_the_p_value_is_reached() {
        let null = NullDistribution::new((0..600).map(f64::from).collect());
        for p_value in [0.04, 1e-2, 1e-5] {
            assert!((null.p_value(null.limit(p_value)) / p_value - 1.0).abs() < 1e-9);
        }
        assert!((null.p_value(300.0) - 0.5).abs() < 0.01);
    }

    // Of 600 draws 30 lie in the tail: its scale is known to 18 %, so that a limit at
    // 1e-4, 6.2 scales beyond its start, errs by 1.1 of 18.4 from draw to draw.
    #[test]
    fn the_tail_of_a_chi_squared_law_is_extrapolated() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let law = ChiSquared::new(2.0).unwrap();
        let null = NullDistribution::new((0..600).map(|_| law.sample(&mut rng)).collect());
        let exact = statrs::distribution::ChiSquared::new(2.0).unwrap().inverse_cdf(1.0 - 1e-4);
        assert!((null.limit(1e-4) - exact).abs() < 0.2 * exact, "{}", null.limit(1e-4));
    }
}
