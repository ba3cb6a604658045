//! The distribution of a statistic where nothing is wrong.

/// Share of the draws from which the tail is extrapolated.
const TAIL: f64 = 0.05;

/// Distribution of one statistic under the null hypothesis.
pub(super) struct Null {
    /// Drawn values, ascending.
    sorted: Vec<f64>,
    /// Where the tail begins, and the mean by which it is exceeded beyond.
    tail: (f64, f64),
}

impl Null {
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
