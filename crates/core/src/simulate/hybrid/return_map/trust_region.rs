//! A trust region: how long a step of Newton's method may be, from how well earlier ones were
//! predicted.

/// Steps as a share of the states' sizes: the longer, the better the steps before did what
/// they promised.
pub(super) struct TrustRegion {
    shortest: f64,
    length: f64,
    last: f64,
    expected: f64,
    /// Steps in a row that did not get nearer.
    pub stalled: usize,
}

/// A step that leaves this share of the one before gets nearer, be it not as near as
/// promised: where an axis all but sticks Newton's method converges by thirds.
const NEARER: f64 = 0.75;

/// Share of itself that a whole step may leave: it leaves little, and this is modest.
const MODEST: f64 = 0.1;

impl TrustRegion {
    pub fn new(shortest: f64) -> Self {
        let (last, expected) = (f64::INFINITY, f64::INFINITY);
        Self { shortest, length: shortest, last, expected, stalled: 0 }
    }

    /// The share to take of a step of this size.
    pub fn share(&mut self, longest: f64) -> f64 {
        if longest <= 1.1 * self.expected {
            // What the last step promised was kept: the next may go further.
            (self.length, self.stalled) = (2.0 * self.length, 0);
        } else if longest <= NEARER * self.last {
            self.stalled = 0;
        } else {
            (self.length, self.stalled) = (self.shortest, self.stalled + 1);
        }
        let share = (self.length / longest).min(1.0);
        (self.last, self.expected) = (longest, longest * (1.0 - share).max(MODEST));
        share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_grow_while_they_keep_their_promise_and_shrink_when_they_stop_getting_nearer() {
        let mut region = TrustRegion::new(0.2);
        assert_eq!(region.share(8.0), 0.05);
        assert_eq!(region.share(7.6), 0.8 / 7.6);
        assert_eq!(region.share(6.8), 1.6 / 6.8);
        // Nearer, but not by as much as promised.
        assert_eq!(region.share(5.0), 3.2 / 5.0);
        assert_eq!(region.share(3.0), 1.0);
        assert_eq!((region.share(3.0), region.stalled), (0.2 / 3.0, 1));
    }

    #[test]
    fn steps_that_shrink_by_thirds_stay_whole() {
        let mut region = TrustRegion::new(1.0);
        for power in 0..10 {
            assert_eq!(region.share(3_f64.powi(-power)), 1.0);
        }
        assert_eq!(region.stalled, 0);
    }
}
