//! Computing times.

use serde::Serialize;

/// Median and 95th percentile, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Times {
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// The percentiles of some times, s.
pub(super) fn times(seconds: impl Iterator<Item = f64>) -> Times {
    let mut sorted: Vec<f64> = seconds.collect();
    sorted.sort_by(f64::total_cmp);
    // The smallest value that is at least as large as `percent` percent of the values.
    let percentile = |percent: usize| {
        let rank = (percent * sorted.len()).div_ceil(100).max(1);
        sorted.get(rank - 1).copied().unwrap_or_default()
    };
    Times { median: percentile(50), p95: percentile(95) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_that_occurred() {
        let hundred = (1..=100).map(f64::from);
        assert_eq!(times(hundred), Times { median: 50.0, p95: 95.0 });
        assert_eq!(times([3.0].into_iter()), Times { median: 3.0, p95: 3.0 });
        assert_eq!(times(std::iter::empty()), Times::default());
    }
}
