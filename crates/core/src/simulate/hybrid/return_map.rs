//! The periodic motion reached from rest: a fixed point of the return map, by Newton's method.

mod continuation;
mod periodic_orbit;
mod trust_region;

use crate::effects::Axis;
use crate::plant::Scalar;

use super::super::shooting;
use super::integrate_period::{LOOSE, PeriodIntegration, Precision, TIGHT};
use super::mechanics::{self, Mechanics};
use super::runge_kutta::Vector;
use crate::simulate::base::spectrum;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::piecewise_linear::drive;
use crate::simulate::response::{Counts, NoResponse};
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;
use trust_region::TrustRegion;

/// Oscillations on presliding bristles that are integrated while the periodic motion is looked for,
/// and for the motion that is reported; see [`Precision::most_swings`].
const LOOSE_SWINGS: usize = 16;
const TIGHT_SWINGS: usize = 32;

/// Cells of a period of a cosine while the motion is looked for; interpolated by quintics, its error
/// is 5e-6.
const LOOSE_CELLS: usize = 8;

/// Most Newton steps; after them the motion counts as not periodic.
const MOST_ITERATIONS: usize = 60;

/// Most effort for one point, in exact steps; beyond it the point counts as not periodic. The first
/// number is the same for every input. To it comes an effort for each cell of the input, larger for
/// the first `FEW_CELLS` than for the rest: one pass over a long record takes more than all passes
/// over a cosine. Most motions that settle take a fiftieth of this (of a record a fifth), and those
/// that take more hardly ever settle. A cosine takes a few milliseconds at most.
const EFFORT: usize = 40_000;
const FEW_CELLS: usize = 256;
const EFFORT_PER_CELL: [usize; 2] = [500, 50];

/// First length of the trust region, as a share of the states' sizes: where several periodic motions
/// may exist, and where there is only one.
const FIRST_REGION: [f64; 2] = [0.2, 4.0];

fn effort(cells: usize) -> usize {
    let few = cells.min(FEW_CELLS);
    EFFORT + EFFORT_PER_CELL[0] * few + EFFORT_PER_CELL[1] * (cells - few)
}

/// Length of a Newton step, as a share of the states' sizes, below which the loose search ends and
/// the precise one begins.
const NEAR: f64 = 1e-2;

/// Length of a Newton step below which the search ends: what remains is its square, which is less
/// than the error of the integration.
const CLOSED: f64 = 5e-4;

/// The same for the angle of a torque that is periodic in the position, radians.
const CLOSED_TURN: f64 = 1.4e-3;

/// A velocity below this share of its size is set to zero after a Newton step: rounding would
/// otherwise move an axis that friction holds.
const STILL: f64 = 1e-9;

/// Error of a period as a multiple of the error of a step.
const PASS_ERROR: f64 = 10.0;

/// The unknowns of a periodic motion of M states: the states at the beginning of a period.
pub(super) struct Periodic<const M: usize> {
    /// States; where the mean of θ matters the last is the constant torque.
    state: Vector<f64, M>,
    region: f64,
    precision: Precision<M>,
    /// Sizes of the unknowns: those of the states, and of the torque.
    sizes: [f64; M],
    /// Remaining effort, in exact steps.
    effort: usize,
}

/// Harmonics of v, and what must vanish over a period.
pub(super) struct Followed<S, const M: usize> {
    pub velocity: Vec<ComplexDual<S>>,
    pub residuals: Vector<S, M>,
}

impl<const M: usize> Periodic<M> {
    /// Finds the periodic motion reached from rest, or one that `counts` instead; `None` where the
    /// axis stays at rest.
    pub fn find(
        axis: &Axis,
        excitation: &Excitation,
        counts: Counts,
    ) -> Result<Option<Self>, NoResponse> {
        let (wave, _) = drive::torque(axis, excitation, LOOSE_CELLS);
        let mut mechanics = Mechanics::new(axis);
        let range = wave.range();
        let rests = match axis.balanced {
            true => mechanics.rests_balanced(range),
            false => mechanics.comes_to_rest(range),
        };
        if rests {
            return Ok(None);
        }
        let sizes = mechanics.sizes(range.0.abs().max(range.1.abs()), wave.period_s);
        let mut periodic = Self {
            state: [0.0; M],
            region: FIRST_REGION[usize::from(mechanics.contracts() || axis.balanced)],
            precision: Precision { tolerance: LOOSE, sizes, most_swings: LOOSE_SWINGS },
            sizes,
            effort: effort(wave.cells.len()),
        };
        if let Some(i) = mechanics.position_integral {
            mechanics.balance = mechanics.first_balance();
            periodic.state[i] = mechanics.balance;
        }
        let (end, largest) =
            periodic.plain(&mechanics, &wave).ok_or(NoResponse::NotPeriodic { periods: 1 })?;
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
        periodic.find_periodic(axis, &wave, counts)?;
        Ok(Some(periodic))
    }

    /// Integrates one period from the present state; returns the state after it and the largest
    /// states on the way.
    fn plain(
        &mut self,
        mechanics: &Mechanics<f64>,
        wave: &PiecewiseQuintic<f64>,
    ) -> Option<(Vector<f64, M>, [f64; M])> {
        let mut pass = PeriodIntegration {
            mechanics,
            wave,
            precision: &self.precision,
            sums: None,
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

    /// A step's largest entry as a share of the states' sizes.
    fn longest(&self, step: &[f64]) -> f64 {
        largest_share(step.iter().copied(), &self.sizes)
    }

    /// The largest residual as a share of the size of the state it is a change of.
    fn left<S: Scalar>(&self, residuals: &Vector<S, M>) -> f64 {
        largest_share(residuals.iter().map(|r| r.value()), &self.precision.sizes)
    }

    /// Whether a period changes the states no more than its own error does, as
    /// where they settle over many periods.
    fn within_error<S: Scalar>(&self, residuals: &Vector<S, M>) -> bool {
        self.left(residuals) < PASS_ERROR * self.precision.tolerance
    }

    fn advance(&mut self, step: &[f64], scale: f64) {
        for (state, move_by) in self.state.iter_mut().zip(step) {
            *state += scale * move_by;
        }
        let v = &mut self.state[mechanics::VELOCITY];
        if v.abs() < STILL * self.sizes[mechanics::VELOCITY] {
            *v = 0.0;
        }
    }

    /// Integrates one period in dual numbers: derivatives by `parameters` lanes of the axis, then by
    /// the unknowns. Sums the Fourier integrals of v if asked.
    fn follow<S: Scalar>(
        &mut self,
        axis: &Axis<S>,
        wave: &PiecewiseQuintic<S>,
        mut sums: Option<Fourier<'_, S>>,
        parameters: usize,
    ) -> Option<Followed<S, M>> {
        let mut mechanics = Mechanics::new(axis);
        let unknown = |value: f64, lane: usize| {
            S::with_lanes(value, |l| f64::from(u8::from(l == parameters + lane)))
        };
        let mut start: Vector<S, M> = std::array::from_fn(|i| unknown(self.state[i], i));
        if let Some(i) = mechanics.position_integral {
            mechanics.balance = unknown(self.state[i], i);
            start[i] = S::constant(0.0);
        }
        let torque = wave.cells[0].fixed(0.0);
        if mechanics.mode_at(torque, &start).motion == Motion::Stuck {
            start[mechanics::VELOCITY] = S::constant(0.0);
        }
        let mut pass = PeriodIntegration {
            mechanics: &mechanics,
            wave,
            precision: &self.precision,
            sums: sums.as_mut(),
            trace: None,
            largest: [0.0; M],
            swings: 0,
            effort: &mut self.effort,
        };
        let end = pass.run(&start)?;
        let residual = |i: usize| match mechanics.position_integral {
            Some(integral) if integral == i => end[i],
            _ => end[i] - unknown(self.state[i], i),
        };
        let residuals = std::array::from_fn(residual);
        let weighted = |(k, sum): (usize, ComplexDual<S>)| {
            let scaled = sum.scaled(S::constant(spectrum::weight(k, wave.period_s)));
            if k == 0 { ComplexDual::real(scaled.re) } else { scaled }
        };
        let sums = sums.map(|sums| sums.finish().into_iter().enumerate().map(weighted).collect());
        Some(Followed { velocity: sums.unwrap_or_default(), residuals })
    }

    /// Harmonics of v at full precision, with derivatives by `parameters` lanes of the axis and, in
    /// the lanes after those, by the unknowns.
    pub fn velocity<S: Scalar>(
        &mut self,
        axis: &Axis<S>,
        (wave, grid): (PiecewiseQuintic<S>, &Grid),
        highest: usize,
        parameters: usize,
    ) -> Result<Followed<S, M>, NoResponse> {
        let omega = std::f64::consts::TAU / wave.period_s;
        (self.precision.tolerance, self.precision.most_swings) = (TIGHT, TIGHT_SWINGS);
        let mut region = TrustRegion::new(self.region);
        let position = Mechanics::new(axis).position;
        let turns = axis.ripple_rate() * position.map_or(0.0, |i| self.sizes[i]);
        for _ in 0..MOST_ITERATIONS {
            let sums = Fourier::new(grid, omega, highest);
            let Some(mut followed) = self.follow(axis, &wave, Some(sums), parameters) else {
                break;
            };
            let step = shooting::newton_step(&followed.residuals, parameters);
            let longest = self.longest(step.as_slice());
            let rests = longest < self.region && self.within_error(&followed.residuals);
            let turn = longest * turns;
            if (longest < CLOSED && turn < CLOSED_TURN) || (rests && !axis.balanced) {
                shooting::correct(&mut followed.velocity, step.as_slice(), parameters);
                return Ok(followed);
            }
            if !longest.is_finite() {
                break;
            }
            self.advance(step.as_slice(), region.share(longest));
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
