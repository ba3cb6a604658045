//! A trust region: limits the length of Newton steps by how well the size of the steps before was
//! predicted.

/// The trust region. Lengths are shares of the states' sizes. The region doubles when the Newton
/// step has shrunk as predicted, and returns to its initial radius when steps stop shrinking.
pub(super) struct TrustRegion {
    /// Initial radius.
    shortest: f64,
    /// Present radius.
    length: f64,
    /// Size of the last Newton step.
    last: f64,
    /// Predicted size of the next one.
    expected: f64,
    /// Steps in a row that did not reduce the next step.
    pub stalled: usize,
}

/// A step of at most this share of the one before counts as progress, even if that is less than
/// predicted: close to sticking, Newton's method converges only linearly, by a factor of a third.
const PROGRESS_RATIO: f64 = 0.75;

/// After a full step, the next one is predicted to have this share of its size. In theory it has
/// the order of its square.
const PREDICTED_REMAINDER: f64 = 0.1;

impl TrustRegion {
    pub fn new(shortest: f64) -> Self {
        let (last, expected) = (f64::INFINITY, f64::INFINITY);
        Self { shortest, length: shortest, last, expected, stalled: 0 }
    }

    /// The share to take of a Newton step of this size.
    pub fn share(&mut self, step_size: f64) -> f64 {
        if step_size <= 1.1 * self.expected {
            // As predicted, or better.
            (self.length, self.stalled) = (2.0 * self.length, 0);
        } else if step_size <= PROGRESS_RATIO * self.last {
            self.stalled = 0;
        } else {
            (self.length, self.stalled) = (self.shortest, self.stalled + 1);
        }
        let share = (self.length / step_size).min(1.0);
        (self.last, self.expected) =
            (step_size, step_size * (1.0 - share).max(PREDICTED_REMAINDER));
        share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_region_grows_while_steps_shrink_as_predicted_and_resets_when_they_stop_shrinking() {
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
