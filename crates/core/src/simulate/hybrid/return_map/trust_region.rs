//! A trust region: how long a step of Newton's method may be, from how well earlier ones were
//! predicted.

/// The longest step allowed, as a share of the states' sizes. It doubles after a step that reduced
/// the next one as predicted, and falls back to the shortest when steps stop shrinking.
pub(super) struct TrustRegion {
    shortest: f64,
    length: f64,
    last: f64,
    expected: f64,
    /// Steps in a row that did not reduce the next step.
    pub stalled: usize,
}

/// A step at most this share of the one before counts as progress, even if less than predicted:
/// close to sticking, Newton's method converges only linearly, by a factor of a third.
const NEARER: f64 = 0.75;

/// A full step is predicted to leave this share of itself; in theory it leaves its square.
const MODEST: f64 = 0.1;

impl TrustRegion {
    pub fn new(shortest: f64) -> Self {
        let (last, expected) = (f64::INFINITY, f64::INFINITY);
        Self { shortest, length: shortest, last, expected, stalled: 0 }
    }

    /// The share to take of a step of this size.
    pub fn share(&mut self, longest: f64) -> f64 {
        if longest <= 1.1 * self.expected {
            // As predicted, or better: the next step may be longer.
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
        // Progress, but less than predicted.
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
