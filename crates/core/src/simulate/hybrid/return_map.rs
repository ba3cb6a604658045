//! The periodic motion as a fixed point of the return map (the state after a period as a function
//! of the state before it), by Newton's method. The derivatives that it needs are carried along
//! with the integration (`sensitivity`).
//!
//! `one_period` integrates a period. `periodic_orbit` searches for the motion reached from rest with a loose tolerance,
//! `continuation` for that of a balanced axis. [`Periodic::velocity`] then finishes Newton's method
//! at full precision.

mod continuation;
mod effort;
mod one_period;
mod periodic_orbit;
mod trust_region;

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::super::shooting;
use super::integrate_period::{LOOSE_TOLERANCE, Precision, TIGHT_TOLERANCE};
use super::mechanics::{self, MOST_STATES, Mechanics};
use super::runge_kutta::Vector;
use crate::simulate::last_motion::Beginning;
use crate::simulate::piecewise_linear::drive::{self, TorqueDerivatives};
use crate::simulate::response::{Counts, NoResponse};
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;
use effort::effort;
pub(super) use one_period::PeriodResult;
use periodic_orbit::Convergence;
use trust_region::TrustRegion;

/// Oscillations on presliding bristles that are integrated in the loose search, and for the motion
/// that is reported; see [`Precision::most_swings`].
const LOOSE_SWINGS: usize = 16;
const TIGHT_SWINGS: usize = 32;

/// Cells of a period of a cosine in the loose search: the quintics err by 5e-6.
const LOOSE_CELLS: usize = 8;

/// Most Newton steps; after them the motion counts as not periodic.
const MOST_ITERATIONS: usize = 60;

/// Initial radius of the trust region, as a share of the states' sizes: if several periodic motions
/// may exist, and if there is only one. Tuned.
const INITIAL_TRUST_RADIUS: [f64; 2] = [0.2, 4.0];

/// The loose search ends at a Newton step below this share of the states' sizes.
const LOOSE_STEP_TOLERANCE: f64 = 1e-2;

/// The precise search ends at a Newton step below this share of the states' sizes. The error left
/// is of the order of its square, less than the error of the integration.
const STEP_TOLERANCE: f64 = 5e-4;

/// The same for the step of the angle of a torque that is periodic in the position, radians.
const ANGLE_STEP_TOLERANCE: f64 = 1.4e-3;

/// A velocity below this share of its size is set to zero after a Newton step. Otherwise rounding
/// would move an axis that friction holds.
const ZERO_VELOCITY_SHARE: f64 = 1e-9;

/// Error of the integration over a period, as a multiple of the largest error of a step. Tuned.
const PERIOD_ERROR_RATIO: f64 = 10.0;

/// The unknowns of a periodic motion of M states: the states at the beginning of a period.
pub(super) struct Periodic<const M: usize> {
    /// The states. If the mean of θ must be zero, the last unknown is the constant torque instead.
    state: Vector<f64, M>,
    /// Initial radius of the trust region.
    region: f64,
    precision: Precision<M>,
    /// Sizes of the unknowns: of the states, and of the constant torque.
    sizes: [f64; M],
    /// Remaining effort, in exact steps.
    effort: usize,
}

/// The torque over a period, its derivatives by the lanes of the axis, and the grid of its cells.
pub(super) type Drive<'a> = (PiecewiseQuintic<f64>, TorqueDerivatives, &'a Grid);

impl<const M: usize> Periodic<M> {
    /// Finds the periodic motion reached from rest, or another one if `counts` allows it, at loose
    /// precision; `None` if the axis stays at rest.
    ///
    /// # Errors
    /// [`NoResponse::NotPeriodic`].
    pub fn find(
        axis: &Axis,
        excitation: &Excitation,
        counts: Counts<'_>,
    ) -> Result<Option<Self>, NoResponse> {
        let (forcing, _) = drive::torque(axis, excitation, LOOSE_CELLS);
        let mut mechanics = Mechanics::new(axis);
        let range = forcing.range();
        let rests = match axis.balanced {
            true => mechanics.rests_balanced(range),
            false => mechanics.comes_to_rest(range),
        };
        if rests {
            return Ok(None);
        }
        let sizes = mechanics.sizes(range.0.abs().max(range.1.abs()), forcing.period_s);
        let mut periodic = Self {
            state: [0.0; M],
            region: INITIAL_TRUST_RADIUS[usize::from(mechanics.contracts() || axis.balanced)],
            precision: Precision { tolerance: LOOSE_TOLERANCE, sizes, most_swings: LOOSE_SWINGS },
            sizes,
            effort: effort(forcing.cells.len()),
        };
        if let Counts::Near(last) = counts
            && let Some(beginning) = last.beginning(M)
            && let Some(near) = periodic.near(&beginning, axis, &forcing)
        {
            return Ok(Some(near));
        }
        if let Some(i) = mechanics.position_integral {
            mechanics.balance = mechanics.first_balance();
            periodic.state[i] = mechanics.balance;
        }
        let (end, largest) = periodic
            .integrate_plain(&mechanics, &forcing)
            .ok_or(NoResponse::NotPeriodic { periods: 1 })?;
        if largest.iter().all(|size| *size == 0.0) && !axis.balanced {
            return Ok(None);
        }
        for (size, largest) in periodic.precision.sizes.iter_mut().zip(largest) {
            *size = if largest > 0.0 { largest } else { *size };
        }
        periodic.state = end;
        periodic.sizes = periodic.precision.sizes;
        if let Some(i) = mechanics.position_integral {
            periodic.sizes[i] = range.0.abs().max(range.1.abs());
        }
        periodic.find_periodic(axis, &forcing, counts)?;
        Ok(Some(periodic))
    }

    /// Newton's method from the beginning of the last motion; `None` if it does not converge.
    fn near(
        &self,
        beginning: &Beginning,
        axis: &Axis,
        forcing: &PiecewiseQuintic<f64>,
    ) -> Option<Self> {
        let known = |values: &[f64; MOST_STATES]| std::array::from_fn(|i| values[i]);
        let Beginning { state, sizes: [unknowns, states], .. } = beginning;
        let precision = Precision { sizes: known(states), ..self.precision };
        let mut near = Self { state: known(state), sizes: known(unknowns), precision, ..*self };
        let converged = near.newton(axis, forcing, None)?;
        matches!(converged, Convergence::Stable | Convergence::Unstable).then_some(near)
    }

    /// Remembers where the motion began, if the next simulation starts from there.
    pub fn remember(&self, counts: Counts<'_>) {
        let Counts::Near(last) = counts else { return };
        let known =
            |values: &[f64; M]| std::array::from_fn(|i| values.get(i).copied().unwrap_or_default());
        let sizes = [known(&self.sizes), known(&self.precision.sizes)];
        last.remember(Beginning { states: M, state: known(&self.state), sizes });
    }

    /// Size of a Newton step: its largest entry as a share of the unknowns' sizes.
    fn step_size(&self, step: &[f64]) -> f64 {
        largest_share(step.iter().copied(), &self.sizes)
    }

    /// The largest residual as a share of the size of its state.
    fn largest_residual<const N: usize>(&self, residuals: &Vector<Dual<N>, M>) -> f64 {
        largest_share(residuals.iter().map(|r| r.value()), &self.precision.sizes)
    }

    /// Whether the states change over a period by no more than the error of the integration. This
    /// also ends the search where the return map is nearly the identity and Newton steps stay
    /// large.
    fn within_error<const N: usize>(&self, residuals: &Vector<Dual<N>, M>) -> bool {
        self.largest_residual(residuals) < PERIOD_ERROR_RATIO * self.precision.tolerance
    }

    /// Moves the unknowns by `scale` times a Newton step.
    fn advance(&mut self, step: &[f64], scale: f64) {
        for (state, move_by) in self.state.iter_mut().zip(step) {
            *state += scale * move_by;
        }
        let v = &mut self.state[mechanics::VELOCITY];
        if v.abs() < ZERO_VELOCITY_SHARE * self.sizes[mechanics::VELOCITY] {
            *v = 0.0;
        }
    }

    /// Harmonics of v at full precision, with derivatives by `parameters` lanes of the axis and, in
    /// the lanes after those, by the unknowns.
    ///
    /// # Errors
    /// [`NoResponse::NotPeriodic`].
    pub fn velocity<const N: usize>(
        &mut self,
        axis: &Axis<Dual<N>>,
        (forcing, torque, grid): Drive<'_>,
        highest: usize,
        parameters: usize,
    ) -> Result<PeriodResult<N, M>, NoResponse> {
        let omega = std::f64::consts::TAU / forcing.period_s;
        (self.precision.tolerance, self.precision.most_swings) = (TIGHT_TOLERANCE, TIGHT_SWINGS);
        let mut region = TrustRegion::new(self.region);
        let position = Mechanics::new(axis).position;
        let angle_per_size = axis.ripple_rate() * position.map_or(0.0, |i| self.sizes[i]);
        for _ in 0..MOST_ITERATIONS {
            let sums = Fourier::new(grid, omega, highest);
            let Some(mut followed) = self.follow(axis, (&forcing, &torque), Some(sums), parameters)
            else {
                break;
            };
            let step = shooting::newton_step(&followed.residuals, parameters);
            let step_size = self.step_size(step.as_slice());
            let settled = step_size < self.region && self.within_error(&followed.residuals);
            let angle = step_size * angle_per_size;
            if (step_size < STEP_TOLERANCE && angle < ANGLE_STEP_TOLERANCE)
                || (settled && !axis.balanced)
            {
                shooting::correct(&mut followed.velocity, step.as_slice(), parameters);
                return Ok(followed);
            }
            if !step_size.is_finite() {
                break;
            }
            self.advance(step.as_slice(), region.share(step_size));
        }
        Err(NoResponse::NotPeriodic { periods: MOST_ITERATIONS })
    }
}

/// The largest of some values, each as a share of its size; a NaN counts as infinite.
fn largest_share(values: impl Iterator<Item = f64>, sizes: &[f64]) -> f64 {
    let shares = values.zip(sizes).map(|(value, size)| (value / size).abs());
    shares
        .fold(0.0, |most: f64, share| if share.is_nan() { f64::INFINITY } else { most.max(share) })
}
