//! Jumps of a channel that come a sample earlier or later in one period.

use super::SAME_PLACE;

/// A channel jumps where it moves, from one sample to the next, by more than this many times the median:
/// the largest of a million normal values is 7.4 times the median of their sizes.
const JUMP: f64 = 8.0;

/// Deviations of a sample within which it is as large as another.
const AS_LARGE: f64 = 5.0;

/// Where the usual period of a channel jumps.
pub(super) struct Jumps<'a> {
    usual: &'a [f64],
    /// Largest move from one sample to the next that is no jump.
    most: f64,
}

impl<'a> Jumps<'a> {
    /// Those of a period.
    pub fn of(usual: &'a [f64]) -> Self {
        let mut jumps = Self { usual, most: 0.0 };
        let mut moves: Vec<f64> = (0..usual.len()).map(|place| jumps.moved(place)).collect();
        let middle = moves.len() / 2;
        jumps.most = JUMP * *moves.select_nth_unstable_by(middle, f64::total_cmp).1;
        jumps
    }

    /// Whether samples in a row from this place on are what the period has a sample before or after,
    /// beside a jump. `std` is the standard deviation of a sample.
    pub fn explain(&self, samples: &[f64], place: usize, std: f64) -> bool {
        let length = self.usual.len();
        let near = place + length - SAME_PLACE % length..place + length + SAME_PLACE;
        let has_jump = near.into_iter().any(|place| self.moved(place) > self.most);
        let is_beside = |(place, sample): (usize, &f64)| {
            let around = [0, 1, 2].map(|shift| self.usual[(place + length - 1 + shift) % length]);
            let low = around.iter().copied().fold(f64::INFINITY, f64::min);
            let high = around.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (low - AS_LARGE * std..=high + AS_LARGE * std).contains(sample)
        };
        has_jump && (place..).zip(samples).all(is_beside)
    }

    /// Move from the sample at a place to the next.
    fn moved(&self, place: usize) -> f64 {
        let length = self.usual.len();
        (self.usual[(place + 1) % length] - self.usual[place % length]).abs()
    }
}
