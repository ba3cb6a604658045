//! The periodic motion as a fixed point of the return map (the state after a period as a function
//! of the state before it), by Newton's method in dual numbers.
//!
//! `periodic_orbit` searches for the motion reached from rest with a loose tolerance,
//! `continuation` for that of a balanced axis. [`Periodic::velocity`] then finishes Newton's method
//! at full precision.

mod continuation;
mod periodic_orbit;
mod trust_region;

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::super::shooting;
use super::integrate_period::{LOOSE_TOLERANCE, PeriodIntegration, Precision, TIGHT_TOLERANCE};
use super::mechanics::{self, MOST_STATES, Mechanics};
use super::runge_kutta::Vector;
use super::sensitivity::Sensitivity;
use crate::simulate::base::spectrum;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::last_motion::Beginning;
use crate::simulate::piecewise_linear::drive::{self, TorqueDerivatives};
use crate::simulate::response::{Counts, NoResponse};
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;
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

/// Most effort for one point, as a number of exact steps; beyond it the point counts as not
/// periodic. `BASE_EFFORT` is the same for every input. Each cell of the input adds to it: the
/// first `FEW_CELLS` cells `EFFORT_PER_CELL[0]` each, the others `EFFORT_PER_CELL[1]`. One pass
/// over a long record takes more steps than all passes over a cosine. Tuned: most motions that
/// settle take a fiftieth of this (a fifth for a record), and those that take more hardly ever
/// settle. A cosine takes a few milliseconds at most.
const BASE_EFFORT: usize = 40_000;
const FEW_CELLS: usize = 256;
const EFFORT_PER_CELL: [usize; 2] = [500, 50];

/// Initial radius of the trust region, as a share of the states' sizes: if several periodic motions
/// may exist, and if there is only one. Tuned.
const INITIAL_TRUST_RADIUS: [f64; 2] = [0.2, 4.0];

fn effort(cells: usize) -> usize {
    let few = cells.min(FEW_CELLS);
    BASE_EFFORT + EFFORT_PER_CELL[0] * few + EFFORT_PER_CELL[1] * (cells - few)
}

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

/// Result of one period: the harmonics of v, and the residuals, which vanish for a periodic motion.
pub(super) struct PeriodResult<const N: usize, const M: usize> {
    pub velocity: Vec<ComplexDual<Dual<N>>>,
    pub residuals: Vector<Dual<N>, M>,
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

    /// Integrates one period from the present state, without derivatives. Returns the state after
    /// it and the largest absolute values of the states.
    fn integrate_plain(
        &mut self,
        mechanics: &Mechanics<f64>,
        forcing: &PiecewiseQuintic<f64>,
    ) -> Option<(Vector<f64, M>, [f64; M])> {
        let mut pass = PeriodIntegration {
            mechanics,
            forcing,
            precision: &self.precision,
            sums: None,
            companion: None,
            trace: None,
            largest: [0.0; M],
            swings: 0,
            effort: &mut self.effort,
        };
        let mut start = self.state;
        if let Some(i) = mechanics.position_integral {
            start[i] = 0.0;
        }
        let mut end = pass.run(&start)?;
        if let Some(i) = mechanics.position_integral {
            end[i] = self.state[i];
        }
        Some((end, pass.largest))
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

    /// Integrates one period with derivatives. The first `parameters` lanes are those of the axis,
    /// the next ones the unknowns. Sums the Fourier integrals of v if `sums` is given.
    fn follow<const N: usize>(
        &mut self,
        axis: &Axis<Dual<N>>,
        (forcing, torque): (&PiecewiseQuintic<f64>, &TorqueDerivatives),
        sums: Option<Fourier<'_, Dual<N>>>,
        parameters: usize,
    ) -> Option<PeriodResult<N, M>> {
        let mut mechanics = Mechanics::new(&axis.map(Dual::value));
        let mut lifted = Mechanics::new(axis);
        let unknown = |value: f64, lane: usize| {
            Dual::with_lanes(value, |l| f64::from(u8::from(l == parameters + lane)))
        };
        let mut start = self.state;
        let mut lanes: [[f64; N]; M] =
            std::array::from_fn(|i| std::array::from_fn(|lane| unknown(0.0, i).lane(lane)));
        if let Some(i) = mechanics.position_integral {
            mechanics.balance = self.state[i];
            lifted.balance = unknown(self.state[i], i);
            (start[i], lanes[i]) = (0.0, [0.0; N]);
        }
        let at_rest = mechanics.mode_at(forcing.cells[0].fixed(0.0), &start);
        if at_rest.motion == Motion::Stuck {
            (start[mechanics::VELOCITY], lanes[mechanics::VELOCITY]) = (0.0, [0.0; N]);
        }
        let mut sensitivity = Sensitivity::new(&lifted, (forcing, torque), sums, lanes);
        let mut pass = PeriodIntegration {
            mechanics: &mechanics,
            forcing,
            precision: &self.precision,
            sums: None,
            companion: Some(&mut sensitivity),
            trace: None,
            largest: [0.0; M],
            swings: 0,
            effort: &mut self.effort,
        };
        let end = pass.run(&start)?;
        let end = |i: usize| Dual::with_lanes(end[i], |lane| sensitivity.lanes[i][lane]);
        let residual = |i: usize| match mechanics.position_integral {
            Some(integral) if integral == i => end(i),
            _ => end(i) - unknown(self.state[i], i),
        };
        let residuals = std::array::from_fn(residual);
        let weighted = |(k, sum): (usize, ComplexDual<Dual<N>>)| {
            let scaled = sum.scaled(Dual::constant(spectrum::weight(k, forcing.period_s)));
            if k == 0 { ComplexDual::real(scaled.re) } else { scaled }
        };
        let sums = sensitivity.sums;
        let sums = sums.map(|sums| sums.finish().into_iter().enumerate().map(weighted).collect());
        Some(PeriodResult { velocity: sums.unwrap_or_default(), residuals })
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
