//! Continuation (homotopy) to the periodic motion of a balanced axis: a constant torque keeps its
//! mean position at zero, against a torque that is periodic in the position (cogging).
//!
//! The constant torque is unknown, so that integrating from rest does not lead to the motion.
//! Without the periodic torque the axis has one periodic motion. From there the periodic torque
//! grows in steps to its full size; after each step a damped Newton's method corrects the motion.

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::{LOOSE_STEP_TOLERANCE, Periodic};
use crate::simulate::hybrid::NoResponse;
use crate::simulate::piecewise_linear::drive::TorqueDerivatives;
use crate::simulate::shooting;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Most Newton steps at one size of the periodic torque.
const MOST_NEWTON_STEPS: usize = 12;

/// Smallest share of a Newton step that the damping tries.
const SMALLEST_SHARE: f64 = 1.0 / 32.0;

/// Longest Newton step, as a share of the unknowns' sizes; a longer one may lead to another branch
/// of periodic motions. Tuned.
const LONGEST_STEP: f64 = 0.5;

/// Smallest step in the share of the periodic torque; below it the continuation fails.
const SMALLEST_GROWTH: f64 = 1.0 / 256.0;

impl<const M: usize> Periodic<M> {
    /// Follows the branch of periodic motions while the periodic torque grows from zero to its full
    /// size.
    ///
    /// # Errors
    /// [`NoResponse::NotPeriodic`].
    pub(super) fn continue_to_periodic(
        &mut self,
        axis: &Axis,
        forcing: &PiecewiseQuintic<f64>,
    ) -> Result<(), NoResponse> {
        let (mut share, mut growth, mut periods) = (0.0, 1.0, 0);
        loop {
            let before = self.state;
            let eased = axis.with_ripple(share).map(Dual::<M>::constant);
            if self.correct_damped(&eased, forcing, &mut periods) {
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
    /// converges; adds the number of integrations to `periods`.
    fn correct_damped(
        &mut self,
        axis: &Axis<Dual<M>>,
        forcing: &PiecewiseQuintic<f64>,
        periods: &mut usize,
    ) -> bool {
        let mut follow = |this: &mut Self| {
            *periods += 1;
            this.follow(axis, (forcing, &TorqueDerivatives::NONE), None, 0)
                .map(|followed| followed.residuals)
        };
        let Some(mut residuals) = follow(self) else { return false };
        for _ in 0..MOST_NEWTON_STEPS {
            let step = shooting::newton_step(&residuals, 0);
            let step_size = self.step_size(step.as_slice());
            if !step_size.is_finite() {
                return false;
            }
            if step_size < LOOSE_STEP_TOLERANCE {
                self.advance(step.as_slice(), 1.0);
                return true;
            }
            let (start, largest_residual) = (self.state, self.largest_residual(&residuals));
            let mut scale = (LONGEST_STEP / step_size).min(1.0);
            residuals = loop {
                self.advance(step.as_slice(), scale);
                let Some(next) = follow(self) else { return false };
                if self.largest_residual(&next) < (1.0 - 0.1 * scale) * largest_residual {
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
