//! Continuation to the periodic motion of an axis whose position is held by a constant torque.
//!
//! That torque is unknown, so that integrating from rest leads nowhere. Without the torque that
//! depends on the position θ the axis has one periodic motion. From there, that torque grows in steps
//! to its full size, and at each the damped Newton's method corrects the motion.

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::{NEAR, Periodic};
use crate::simulate::hybrid::NoResponse;
use crate::simulate::shooting;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Most Newton steps at one size of the periodic torque.
const CORRECTIONS: usize = 12;

/// Smallest share of a Newton step that is tried.
const SMALLEST_SHARE: f64 = 1.0 / 32.0;

/// Longest Newton step, as a share of the unknowns' sizes: longer ones may lead to another branch of
/// periodic motions.
const LONGEST: f64 = 0.5;

/// Smallest step in the size of the periodic torque; below it the continuation fails.
const SMALLEST_GROWTH: f64 = 1.0 / 256.0;

impl<const M: usize> Periodic<M> {
    /// Follows the branch of periodic motions while the torque that is periodic in the position grows
    /// from zero to its full size.
    pub(super) fn continue_to_periodic(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
    ) -> Result<(), NoResponse> {
        let lifted = wave.map(Dual::<M>::constant);
        let (mut share, mut growth, mut periods) = (0.0, 1.0, 0);
        loop {
            let before = self.state;
            let eased = axis.with_ripple(share).map(Dual::<M>::constant);
            if self.correct_damped(&eased, &lifted, &mut periods) {
                if share >= 1.0 {
                    return Ok(());
                }
            } else {
                self.state = before;
                share -= growth;
                growth *= 0.5;
                if share < 0.0 || growth < SMALLEST_GROWTH {
                    return Err(NoResponse::NotPeriodic { periods });
                }
            }
            growth = growth.min(1.0 - share);
            share += growth;
        }
    }

    /// Damped Newton's method: each step is halved until the residual shrinks. Returns whether it
    /// converges.
    fn correct_damped(
        &mut self,
        axis: &Axis<Dual<M>>,
        wave: &PiecewiseQuintic<Dual<M>>,
        periods: &mut usize,
    ) -> bool {
        let mut follow = |this: &mut Self| {
            *periods += 1;
            this.follow(axis, wave, None, 0).map(|followed| followed.residuals)
        };
        let Some(mut residuals) = follow(self) else { return false };
        for _ in 0..CORRECTIONS {
            let step = shooting::newton_step(&residuals, 0);
            let longest = self.longest(step.as_slice());
            if !longest.is_finite() {
                return false;
            }
            if longest < NEAR {
                self.advance(step.as_slice(), 1.0);
                return true;
            }
            let (start, left) = (self.state, self.left(&residuals));
            let mut scale = (LONGEST / longest).min(1.0);
            residuals = loop {
                self.advance(step.as_slice(), scale);
                let Some(next) = follow(self) else { return false };
                if self.left(&next) < (1.0 - 0.1 * scale) * left {
                    break next;
                }
                self.state = start;
                scale *= 0.5;
                if scale < SMALLEST_SHARE {
                    return false;
                }
            };
        }
        false
    }
}
