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

/// Newton's steps in a row that may fail to get nearer.
const PATIENT: usize = 3;

/// Newton's steps from one place of a motion that has an unstable one beside it: what they do
/// not close by then they wander about.
const MOST_STEPS: usize = 20;

/// Periods followed from rest after the first before Newton's method is tried again.
const FIRST_PERIODS: usize = 4;

/// Change of the states over a period, as a share of their sizes, from which on Newton's method
/// may lead from one of several motions to another, and periods followed until it is less.
const FAR: f64 = 0.05;
const APPROACH: usize = 8;

/// Periods followed from rest after which the motion counts as not periodic.
const MOST_PERIODS: usize = 500;

/// Size of a multiplier from which on a motion is unstable: what rounding and a loose step make
/// of those that are exactly 1, such as of a twist within the play of an axis that friction
/// holds, is less.
const UNSTABLE: f64 = 1.02;

/// Sweeps after which the multipliers of so few states are found, if ever.
const MOST_SWEEPS: usize = 200;

/// Share of the effort for one point that is kept for an unstable motion once no other is found.
const RESERVE: usize = 4;

/// Where Newton's method has come to.
enum Closing {
    Stable,
    Unstable,
    Wanders,
}

impl<const M: usize> Periodic<M> {
    /// Newton's method at loose precision until it hardly moves, from the end of the first
    /// period, or where motions may not be unique from that of one that hardly changes them.
    /// Where it does not get nearer, the motion itself is followed for some periods, and
    /// more each time; where it comes to a motion that no axis stays in, the motion from rest
    /// is; that of a balanced axis, as its ripple grows.
    pub(super) fn close(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
        counts: Counts,
    ) -> Result<(), NoResponse> {
        let mut unstable = None;
        self.settle(axis, wave, &mut unstable).or_else(|error| match (counts, unstable) {
            (Counts::EvenUnstable, Some(state)) => {
                self.state = state;
                self.effort = self.effort.max(effort(wave.cells.len()) / RESERVE);
                Ok(())
            }
            _ => Err(error),
        })
    }

    /// The same, with the first unstable motion that was met on the way.
    fn settle(
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
                Closing::Stable => return Ok(()),
                Closing::Unstable if unstable.is_none() => {
                    *unstable = Some(self.state);
                    patience = FIRST_PERIODS;
                }
                Closing::Unstable | Closing::Wanders => {}
            }
            if axis.balanced {
                self.state = rested;
                return self.continue_to_periodic(axis, wave);
            }
            // Newton's method has brought what settles slowly nearer, unless it has been led
            // astray.
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

    /// Follows the motion until a period hardly changes it, and says for how many; `None` where
    /// it cannot be followed.
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

    /// Newton's method from where the motion is. `beside` is the motion from rest where an
    /// unstable one is known; `None` where the motion cannot be followed.
    fn newton(
        &mut self,
        axis: &Axis,
        wave: &PiecewiseQuintic<f64>,
        beside: Option<&Vector<f64, M>>,
    ) -> Option<Closing> {
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
                // What the motion from rest stays at it does not leave, whatever the slope says
                // where a kink is near.
                let stays = beside.is_some_and(|rested| self.distance_from(rested) < NEAR);
                if !(axis.balanced || stays || is_stable(&followed.residuals)) {
                    return Some(Closing::Unstable);
                }
                self.advance(step.as_slice(), (self.region / longest).min(1.0));
                return Some(Closing::Stable);
            }
            let share = region.share(longest);
            if region.stalled >= PATIENT {
                break;
            }
            self.advance(step.as_slice(), share);
        }
        Some(Closing::Wanders)
    }

    /// The largest difference from other states, as a share of the states' sizes.
    fn distance_from(&self, other: &Vector<f64, M>) -> f64 {
        largest_share(self.state.iter().zip(other).map(|(here, there)| here - there), &self.sizes)
    }
}

/// Whether a periodic motion draws those near it towards itself, by its Floquet multipliers:
/// the residuals are the states after a period less those before. Where no multipliers are
/// found it is taken to.
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
