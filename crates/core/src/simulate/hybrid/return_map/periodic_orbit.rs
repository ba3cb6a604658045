//! The search for the periodic motion reached from rest: periods are integrated until the state
//! hardly changes, then Newton's method finds the fixed point of the return map. Floquet
//! multipliers tell whether it is stable.

use nalgebra::{Complex, DMatrix, Schur};

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::effort::effort;
use super::trust_region::TrustRegion;
use super::{LOOSE_STEP_TOLERANCE, MOST_ITERATIONS, Periodic, largest_share};
use crate::simulate::hybrid::mechanics::Mechanics;
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::piecewise_linear::drive::TorqueDerivatives;
use crate::simulate::response::{Counts, NoResponse};
use crate::simulate::shooting;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Newton steps in a row that may fail to shrink before the method stops. Tuned.
const MOST_STALLED_STEPS: usize = 3;

/// Most Newton steps from one starting point once an unstable periodic motion is known. Tuned: with
/// more it does not converge either.
const MOST_STEPS_NEAR_UNSTABLE: usize = 20;

/// Periods integrated before Newton's method is tried for the second time; doubled for each further
/// attempt. Tuned.
const PERIODS_BEFORE_RETRY: usize = 4;

/// If several periodic motions may exist, Newton's method starts when the states change over a
/// period by less than this share of their sizes. From farther away it may find another motion.
/// Tuned.
const LARGEST_CHANGE_BEFORE_NEWTON: f64 = 0.05;

/// Most periods integrated until the change is below [`LARGEST_CHANGE_BEFORE_NEWTON`].
const MOST_APPROACH_PERIODS: usize = 8;

/// Most periods integrated from rest; beyond that the motion counts as not periodic.
const MOST_PERIODS: usize = 500;

/// A motion is unstable if a Floquet multiplier is at least this large. Some multipliers are
/// exactly 1 (a joint may rest anywhere within its play); rounding and integration errors change
/// them by less than 0.02.
const SMALLEST_UNSTABLE_MULTIPLIER: f64 = 1.02;

/// Most iterations of the QR algorithm for the Floquet multipliers; it needs a few for each state.
const MOST_SWEEPS: usize = 200;

/// If an unstable motion is reported in the end, the effort left for it is at least the effort of
/// one point divided by this.
const RESERVED_EFFORT_DIVISOR: usize = 4;

/// How Newton's method ended.
pub(super) enum Convergence {
    Stable,
    Unstable,
    None,
}

impl<const M: usize> Periodic<M> {
    /// Finds the periodic motion reached from rest, at loose precision.
    ///
    /// Newton's method starts from the end of the first period; where several periodic motions may
    /// exist, from the end of a period that hardly changes the state. Where it does not converge,
    /// more periods are integrated before it is tried again, twice as many each time. If it
    /// converges to an unstable motion, this is stored and integration from rest goes on; it is
    /// reported in the end if `counts` allows it and no stable one is found. For a balanced axis
    /// continuation takes the place of integration.
    ///
    /// # Errors
    /// [`NoResponse::NotPeriodic`] where none is found.
    pub(super) fn find_periodic(
        &mut self,
        axis: &Axis,
        forcing: &PiecewiseQuintic<f64>,
        counts: Counts<'_>,
    ) -> Result<(), NoResponse> {
        let mut unstable = None;
        self.find_stable(axis, forcing, &mut unstable).or_else(|error| match (counts, unstable) {
            (Counts::EvenUnstable | Counts::Near(_), Some(state)) => {
                self.state = state;
                self.effort =
                    self.effort.max(effort(forcing.cells.len()) / RESERVED_EFFORT_DIVISOR);
                Ok(())
            }
            _ => Err(error),
        })
    }

    /// The same for stable motions only; stores the first unstable one in `unstable`.
    fn find_stable(
        &mut self,
        axis: &Axis,
        forcing: &PiecewiseQuintic<f64>,
        unstable: &mut Option<Vector<f64, M>>,
    ) -> Result<(), NoResponse> {
        let mechanics = Mechanics::new(axis);
        let mut periods = 1;
        if !axis.balanced && !mechanics.contracts() {
            periods +=
                self.approach(&mechanics, forcing).ok_or(NoResponse::NotPeriodic { periods })?;
        }
        let mut from_rest = self.state;
        let mut extra_periods = PERIODS_BEFORE_RETRY;
        loop {
            let failed = NoResponse::NotPeriodic { periods };
            let state_from_rest = unstable.map(|_| from_rest);
            match self.newton(axis, forcing, state_from_rest.as_ref()).ok_or(failed)? {
                Convergence::Stable => return Ok(()),
                Convergence::Unstable if unstable.is_none() => {
                    *unstable = Some(self.state);
                    extra_periods = PERIODS_BEFORE_RETRY;
                }
                Convergence::Unstable | Convergence::None => {}
            }
            if axis.balanced {
                self.state = from_rest;
                return self.continue_to_periodic(axis, forcing);
            }
            // Integration goes on from the state that Newton's method has reached, which is usually
            // nearer to the periodic motion. Near an unstable motion it goes on from the last state
            // of the motion from rest.
            if unstable.is_some() {
                self.state = from_rest;
            }
            for _ in 0..extra_periods {
                self.state = self.integrate_plain(&mechanics, forcing).ok_or(failed)?.0;
            }
            if unstable.is_some() {
                from_rest = self.state;
            }
            periods += extra_periods;
            if periods > MOST_PERIODS {
                return Err(NoResponse::NotPeriodic { periods });
            }
            extra_periods *= 2;
        }
    }

    /// Integrates periods until one hardly changes the state, and returns their number; `None`
    /// where the motion cannot be integrated.
    fn approach(
        &mut self,
        mechanics: &Mechanics<f64>,
        forcing: &PiecewiseQuintic<f64>,
    ) -> Option<usize> {
        for period in 1..=MOST_APPROACH_PERIODS {
            let before = self.state;
            self.state = self.integrate_plain(mechanics, forcing)?.0;
            if self.distance_from(&before) < LARGEST_CHANGE_BEFORE_NEWTON {
                return Some(period);
            }
        }
        Some(MOST_APPROACH_PERIODS)
    }

    /// Newton's method from the present state. `state_from_rest` is the last state of the motion
    /// from rest; it is given once an unstable motion is known. `None` if the motion cannot be
    /// integrated.
    pub(super) fn newton(
        &mut self,
        axis: &Axis,
        forcing: &PiecewiseQuintic<f64>,
        state_from_rest: Option<&Vector<f64, M>>,
    ) -> Option<Convergence> {
        let lifted = axis.map(Dual::<M>::constant);
        let mut region = TrustRegion::new(self.region);
        let most_steps =
            if state_from_rest.is_some() { MOST_STEPS_NEAR_UNSTABLE } else { MOST_ITERATIONS };
        for _ in 0..most_steps {
            let followed = self.follow(&lifted, (forcing, &TorqueDerivatives::NONE), None, 0)?;
            let step = shooting::newton_step(&followed.residuals, 0);
            let step_size = self.step_size(step.as_slice());
            if !step_size.is_finite() {
                return None;
            }
            if step_size < LOOSE_STEP_TOLERANCE || self.within_error(&followed.residuals) {
                // If the motion from rest has already come to this point, the motion is stable,
                // even if the multipliers say otherwise: at a kink of the return map they hold on
                // one side only.
                let stays = state_from_rest
                    .is_some_and(|from_rest| self.distance_from(from_rest) < LOOSE_STEP_TOLERANCE);
                if !(axis.balanced || stays || is_stable(&followed.residuals)) {
                    return Some(Convergence::Unstable);
                }
                self.advance(step.as_slice(), (self.region / step_size).min(1.0));
                return Some(Convergence::Stable);
            }
            let share = region.share(step_size);
            if region.stalled >= MOST_STALLED_STEPS {
                break;
            }
            self.advance(step.as_slice(), share);
        }
        Some(Convergence::None)
    }

    /// The largest difference from another state vector, as a share of the states' sizes.
    fn distance_from(&self, other: &Vector<f64, M>) -> f64 {
        largest_share(self.state.iter().zip(other).map(|(here, there)| here - there), &self.sizes)
    }
}

/// Whether a periodic motion is stable: all Floquet multipliers (eigenvalues of the monodromy
/// matrix, the derivative of the state after a period by the state before it) are smaller than
/// [`SMALLEST_UNSTABLE_MULTIPLIER`]. `residuals` are the states after a period minus those before
/// it. If the QR algorithm does not converge, the motion counts as stable.
fn is_stable<const M: usize>(residuals: &Vector<Dual<M>, M>) -> bool {
    let monodromy = DMatrix::from_fn(M, M, |row, column| {
        residuals[row].lane(column) + f64::from(u8::from(row == column))
    });
    let schur = Schur::try_new(monodromy, f64::EPSILON, MOST_SWEEPS);
    let repels = |multiplier: &Complex<f64>| multiplier.norm() >= SMALLEST_UNSTABLE_MULTIPLIER;
    !schur.is_some_and(|schur| schur.complex_eigenvalues().iter().any(repels))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rows: [[f64; 2]; 2]) -> Vector<Dual<2>, 2> {
        let less = |row: usize, lane: usize| rows[row][lane] - f64::from(u8::from(row == lane));
        std::array::from_fn(|row| Dual::with_lanes(0.0, |lane| less(row, lane)))
    }

    #[test]
    fn a_motion_is_stable_whose_multipliers_are_within_the_unit_circle() {
        assert!(is_stable(&map([[0.9, 100.0], [0.0, -0.9]])));
        assert!(is_stable(&map([[1.0, 0.0], [0.0, 1.0]])));
        assert!(!is_stable(&map([[1.1, 0.0], [0.0, 0.0]])));
        assert!(!is_stable(&map([[0.0, 0.0], [5.0, -1.5]])));
        // ±1.2j.
        assert!(!is_stable(&map([[0.0, 1.2], [-1.2, 0.0]])));
    }

    #[test]
    fn multipliers_that_are_not_finite_do_not_make_the_qr_algorithm_loop() {
        assert!(is_stable(&map([[f64::NAN, 0.3], [0.1, 0.5]])));
        assert!(!is_stable(&map([[f64::INFINITY, 0.3], [0.1, 0.5]])));
    }
}
