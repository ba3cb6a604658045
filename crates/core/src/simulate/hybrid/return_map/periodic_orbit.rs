//! From rest to the periodic motion: periods are integrated until they hardly change, then Newton's
//! method finds the fixed point.

use nalgebra::{Complex, DMatrix, Schur};

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::trust_region::TrustRegion;
use super::{MOST_ITERATIONS, NEAR, Periodic, effort, largest_share};
use crate::simulate::hybrid::mechanics::Mechanics;
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::response::{Counts, NoResponse};
use crate::simulate::shooting;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Newton steps in a row that may fail to reduce the residual.
const PATIENT: usize = 3;

/// Most Newton steps from one starting point once an unstable periodic motion is known nearby. By
/// experience more do not converge there.
const MOST_STEPS: usize = 20;

/// Periods integrated before Newton's method is tried again for the first time; doubled each time.
const FIRST_PERIODS: usize = 4;

/// Change of the states over one period, as a share of their sizes, above which Newton's method may
/// jump to another of several periodic motions.
const FAR: f64 = 0.05;

/// Most periods integrated until the change is below [`FAR`].
const APPROACH: usize = 8;

/// Periods integrated from rest after which the motion counts as not periodic.
const MOST_PERIODS: usize = 500;

/// Size of a Floquet multiplier above which a motion is unstable. Some multipliers are exactly 1
/// (a joint at rest anywhere within its play); rounding and the error of a step change those by
/// less than 0.02.
const UNSTABLE: f64 = 1.02;

/// Most sweeps of the QR algorithm for the Floquet multipliers; it needs a few for each state.
const MOST_SWEEPS: usize = 200;

/// An unstable motion that is used in the end gets at least 1/RESERVE of the effort of one point.
const RESERVE: usize = 4;

/// How Newton's method ended.
enum Convergence {
    Stable,
    Unstable,
    None,
}

impl<const M: usize> Periodic<M> {
    /// Finds the periodic motion reached from rest, at loose precision.
    ///
    /// Newton's method starts from the end of the first period; where several periodic motions
    /// may exist, from the end of a period that hardly changes the state. Where it does not
    /// converge, more periods are integrated before it is tried again, twice as many each time.
    /// Where it converges to an unstable motion, that one is passed over and integration goes on
    /// from rest; it is used in the end if `counts` allows it and no stable one is found. For a
    /// balanced axis continuation takes the place of integration.
    ///
    /// # Errors
    /// [`NoResponse::NotPeriodic`] where none is found.
    pub(super) fn find_periodic(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
        counts: Counts,
    ) -> Result<(), NoResponse> {
        let mut unstable = None;
        self.find_stable(axis, wave, &mut unstable).or_else(|error| match (counts, unstable) {
            (Counts::EvenUnstable, Some(state)) => {
                self.state = state;
                self.effort = self.effort.max(effort(wave.cells.len()) / RESERVE);
                Ok(())
            }
            _ => Err(error),
        })
    }

    /// The same for stable motions only; stores the first unstable one that it meets.
    fn find_stable(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
        unstable: &mut Option<Vector<f64, M>>,
    ) -> Result<(), NoResponse> {
        let mechanics = Mechanics::new(axis);
        let mut periods = 1;
        if !axis.balanced && !mechanics.contracts() {
            periods +=
                self.approach(&mechanics, wave).ok_or(NoResponse::NotPeriodic { periods })?;
        }
        let mut rested = self.state;
        let mut patience = FIRST_PERIODS;
        loop {
            let failed = NoResponse::NotPeriodic { periods };
            let beside = unstable.map(|_| rested);
            match self.newton(axis, wave, beside.as_ref()).ok_or(failed)? {
                Convergence::Stable => return Ok(()),
                Convergence::Unstable if unstable.is_none() => {
                    *unstable = Some(self.state);
                    patience = FIRST_PERIODS;
                }
                Convergence::Unstable | Convergence::None => {}
            }
            if axis.balanced {
                self.state = rested;
                return self.continue_to_periodic(axis, wave);
            }
            // What Newton's method has reached is nearer to the periodic motion than where it
            // began, unless an unstable motion has led it away.
            if unstable.is_some() {
                self.state = rested;
            }
            for _ in 0..patience {
                self.state = self.plain(&mechanics, wave).ok_or(failed)?.0;
            }
            if unstable.is_some() {
                rested = self.state;
            }
            periods += patience;
            if periods > MOST_PERIODS {
                return Err(NoResponse::NotPeriodic { periods });
            }
            patience *= 2;
        }
    }

    /// Integrates periods until one hardly changes the state, and returns their number; `None`
    /// where the motion cannot be integrated.
    fn approach(
        &mut self,
        mechanics: &Mechanics<f64>,
        wave: &PiecewiseQuintic<f64>,
    ) -> Option<usize> {
        for period in 1..=APPROACH {
            let before = self.state;
            self.state = self.plain(mechanics, wave)?.0;
            if self.distance_from(&before) < FAR {
                return Some(period);
            }
        }
        Some(APPROACH)
    }

    /// Newton's method from the present state. `beside` is the state reached from rest, where an
    /// unstable motion is known. Returns `None` where the motion cannot be integrated.
    fn newton(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
        beside: Option<&Vector<f64, M>>,
    ) -> Option<Convergence> {
        let (lifted_axis, lifted) = (axis.map(Dual::<M>::constant), wave.map(Dual::<M>::constant));
        let mut region = TrustRegion::new(self.region);
        let most = if beside.is_some() { MOST_STEPS } else { MOST_ITERATIONS };
        for _ in 0..most {
            let followed = self.follow(&lifted_axis, &lifted, None, 0)?;
            let step = shooting::newton_step(&followed.residuals, 0);
            let longest = self.longest(step.as_slice());
            if !longest.is_finite() {
                return None;
            }
            if longest < NEAR || self.within_error(&followed.residuals) {
                // Where the motion from rest is at this point already, it is stable, whatever the
                // derivative says: next to a kink that is one-sided.
                let stays = beside.is_some_and(|rested| self.distance_from(rested) < NEAR);
                if !(axis.balanced || stays || is_stable(&followed.residuals)) {
                    return Some(Convergence::Unstable);
                }
                self.advance(step.as_slice(), (self.region / longest).min(1.0));
                return Some(Convergence::Stable);
            }
            let share = region.share(longest);
            if region.stalled >= PATIENT {
                break;
            }
            self.advance(step.as_slice(), share);
        }
        Some(Convergence::None)
    }

    /// The largest difference from other states, as a share of the states' sizes.
    fn distance_from(&self, other: &Vector<f64, M>) -> f64 {
        largest_share(self.state.iter().zip(other).map(|(here, there)| here - there), &self.sizes)
    }
}

/// Whether a periodic motion is stable: no Floquet multiplier (eigenvalue of the derivative of the
/// state after a period by the state before) exceeds [`UNSTABLE`]. `residuals` are the states
/// after a period less those before. A motion whose eigenvalues the QR algorithm does not find
/// counts as stable.
fn is_stable<const M: usize>(residuals: &Vector<Dual<M>, M>) -> bool {
    let monodromy = DMatrix::from_fn(M, M, |row, column| {
        residuals[row].lane(column) + f64::from(u8::from(row == column))
    });
    let schur = Schur::try_new(monodromy, f64::EPSILON, MOST_SWEEPS);
    let repels = |multiplier: &Complex<f64>| multiplier.norm() >= UNSTABLE;
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
    fn multipliers_that_are_no_numbers_do_not_hold_up_the_simulation() {
        assert!(is_stable(&map([[f64::NAN, 0.3], [0.1, 0.5]])));
        assert!(!is_stable(&map([[f64::INFINITY, 0.3], [0.1, 0.5]])));
    }
}
