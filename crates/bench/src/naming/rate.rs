//! Binomial shares with confidence intervals.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};

/// A share of a number of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Rate {
    /// Number of hits.
    pub hits: u32,
    /// Number of trials.
    pub of: u32,
}

impl Rate {
    /// Counts the values that are true.
    pub fn count(values: impl IntoIterator<Item = bool>) -> Self {
        let mut rate = Self::default();
        values.into_iter().for_each(|hit| rate.add(hit));
        rate
    }

    /// Adds one trial.
    pub fn add(&mut self, hit: bool) {
        self.hits += u32::from(hit);
        self.of += 1;
    }

    /// hits/of; `None` if there are no trials.
    pub fn share(&self) -> Option<f64> {
        (self.of > 0).then(|| f64::from(self.hits) / f64::from(self.of))
    }

    /// The exact 95 % interval of a binomial share (Clopper and Pearson 1934,
    /// <https://doi.org/10.1093/biomet/26.4.404>), from quantiles of beta distributions. Its
    /// coverage is at least 95 % even for shares near 0 or 1.
    pub fn interval95(&self) -> [f64; 2] {
        let (hits, misses) = (f64::from(self.hits), f64::from(self.of - self.hits));
        let quantile = |p: f64, a: f64, b: f64| Beta::new(a, b).map(|beta| beta.inverse_cdf(p));
        let low = if self.hits == 0 { Ok(0.0) } else { quantile(0.025, hits, misses + 1.0) };
        let high = if self.hits == self.of { Ok(1.0) } else { quantile(0.975, hits + 1.0, misses) };
        // Both parameters of the beta distributions are at least 1, so these never fail.
        [low.unwrap_or(0.0), high.unwrap_or(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // From tables of the exact interval; e.g. the upper bound for 0 of 30 is 1 − 0.025^(1/30).
    #[test]
    fn intervals_are_those_of_clopper_and_pearson() {
        for (hits, of, low, high) in [
            (0, 30, 0.0, 0.115_703),
            (30, 30, 0.884_297, 1.0),
            (5, 10, 0.187_086, 0.812_914),
            (95, 100, 0.887_165, 0.983_568),
        ] {
            let [found_low, found_high] = Rate { hits, of }.interval95();
            assert!((found_low - low).abs() < 1e-5, "{hits}/{of}: {found_low}");
            assert!((found_high - high).abs() < 1e-5, "{hits}/{of}: {found_high}");
        }
    }

    #[test]
    fn nothing_has_no_share_and_the_widest_interval() {
        let nothing = Rate::count([]);
        assert_eq!((nothing.share(), nothing.interval95()), (None, [0.0, 1.0]));
        assert_eq!(Rate::count([true, false, true, true]).share(), Some(0.75));
    }
}
