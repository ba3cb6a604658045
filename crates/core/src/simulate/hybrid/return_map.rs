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

/// Swings on bristles that are followed while the periodic motion is looked for, and in the
/// end.
const LOOSE_SWINGS: usize = 16;
const TIGHT_SWINGS: usize = 32;

/// Cells of a period of a cosine while the motion is looked for: its quintics miss by 5e-6.
const LOOSE_CELLS: usize = 8;

/// Newton's steps after which the motion counts as not periodic.
const MOST_ITERATIONS: usize = 60;

/// Effort for one point, in exact steps, beyond which it counts as not periodic, and what is
/// added for each cell of its input: of the first `FEW_CELLS`, and of those of a record beyond
/// them, a pass over which takes longer than all that a cosine may. Most motions that settle
/// take a fiftieth of it (of a record a fifth), and hardly any of those that take more settle
/// after all; it bounds a cosine to a few milliseconds.
const EFFORT: usize = 40_000;
const FEW_CELLS: usize = 256;
const EFFORT_PER_CELL: [usize; 2] = [500, 50];

/// Share of a state's size that a step may move it, where motions may not be
/// unique, and where they are.
const LEASH: [f64; 2] = [0.2, 4.0];

fn effort(cells: usize) -> usize {
    let few = cells.min(FEW_CELLS);
    EFFORT + EFFORT_PER_CELL[0] * few + EFFORT_PER_CELL[1] * (cells - few)
}

/// Step, as a share of a state's size, behind which a more precise pass is worth
/// its while.
const NEAR: f64 = 1e-2;

/// Step behind which the rest is linear: its square is below what a pass errs.
const CLOSED: f64 = 5e-4;

/// The same of a step's turn of a ripple, radians.
const CLOSED_TURN: f64 = 1.4e-3;

/// Share of its size below which Newton's method leaves no velocity: rounding would set an
/// axis in motion that friction holds.
const STILL: f64 = 1e-9;

/// Error of a period in errors of a step.
const PASS_ERROR: f64 = 10.0;

/// A periodic motion of M states: what to start a period with.
pub(super) struct Periodic<const M: usize> {
    /// States; where the mean of θ matters the last is the constant torque.
    state: Vector<f64, M>,
    region: f64,
    precision: Precision<M>,
    /// Sizes of the unknowns: those of the states, and of the torque.
    sizes: [f64; M],
    /// Effort that is left, in exact steps.
    effort: usize,
}

/// Harmonics of v, and what must vanish over a period.
pub(super) struct Followed<S, const M: usize> {
    pub velocity: Vec<ComplexDual<S>>,
    pub residuals: Vector<S, M>,
}

impl<const M: usize> Periodic<M> {
    /// Finds the periodic motion reached from rest, or one that `counts` in its place;
    /// `None`: it is rest itself.
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
            region: LEASH[usize::from(mechanics.contracts() || axis.balanced)],
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
        periodic.close(axis, &wave, counts)?;
        Ok(Some(periodic))
    }

    /// One period from where it stands, and the largest states seen.
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

    /// Follows the motion over a period with the unknowns riding behind
    /// `parameters` lanes, adding up v if asked.
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

    /// Harmonics of v at full precision, with derivatives by `parameters` lanes of
    /// the axis; the unknowns ride in the lanes behind them.
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

/// The largest of some values, each as a share of its size; what is no number is larger
/// than any.
fn largest_share(values: impl Iterator<Item = f64>, sizes: &[f64]) -> f64 {
    let shares = values.zip(sizes).map(|(value, size)| (value / size).abs());
    shares
        .fold(0.0, |most: f64, share| if share.is_nan() { f64::INFINITY } else { most.max(share) })
}
