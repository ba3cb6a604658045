//! Comparison of two designs on the same machines.

use serde::Serialize;

use crate::naming::Rate;

/// How often each of two designs names what is hidden, on the same machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Paired {
    /// Both do.
    pub both: u32,
    /// Only the first.
    pub first: u32,
    /// Only the second.
    pub second: u32,
    /// Neither.
    pub neither: u32,
}

impl Paired {
    /// Adds a machine.
    pub fn add(&mut self, first: bool, second: bool) {
        let count = match (first, second) {
            (true, true) => &mut self.both,
            (true, false) => &mut self.first,
            (false, true) => &mut self.second,
            (false, false) => &mut self.neither,
        };
        *count += 1;
    }

    /// How often each of them does.
    pub fn rates(&self) -> [Rate; 2] {
        let of = self.both + self.first + self.second + self.neither;
        [self.first, self.second].map(|alone| Rate { hits: self.both + alone, of })
    }

    /// Probability of a difference that large in either direction if both were equally good: the exact test of
    /// the machines on which they differ (Q. McNemar 1947, doi:10.1007/BF02295996).
    pub fn p_value(&self) -> f64 {
        let differing = self.first + self.second;
        let fewer = self.first.min(self.second);
        let mut term = 0.5_f64.powi(differing as i32);
        let mut tail = term;
        for k in 1..=fewer {
            term *= f64::from(differing - k + 1) / f64::from(k);
            tail += term;
        }
        (2.0 * tail).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_test_is_that_of_a_fair_coin() {
        let of = |first, second| Paired { both: 7, first, second, neither: 3 };
        // 2·(1 + 10)/1024 and 2·0.5⁵.
        assert!((of(9, 1).p_value() - 22.0 / 1024.0).abs() < 1e-12);
        assert!((of(0, 5).p_value() - 0.0625).abs() < 1e-12);
        assert_eq!((of(4, 4).p_value(), of(0, 0).p_value()), (1.0, 1.0));
    }

    #[test]
    fn what_both_name_counts_for_both() {
        let mut paired = Paired::default();
        for (first, second) in [(true, true), (true, false), (true, false), (false, false)] {
            paired.add(first, second);
        }
        let [first, second] = paired.rates();
        assert_eq!((first.hits, second.hits, first.of, second.of), (3, 1, 4, 4));
    }
}
