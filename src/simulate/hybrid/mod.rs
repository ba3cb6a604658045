//! Motion of an axis that is not linear between switches, or has more than one
//! mass, or a position that matters.
//!
//! The equations are stepped by an explicit Runge–Kutta pair with error control
//! (`runge_kutta`), cut where the motion switches (`pass`). The state at the
//! beginning of the period is found by Newton's method on the return map; the
//! derivatives it needs ride along in dual numbers. Where several periodic
//! motions may exist the one reached from rest counts: Newton's step is then kept
//! so short that it follows the motion's own slow approach.

mod mechanics;
mod pass;
mod runge_kutta;

use std::ops::Range;

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Dual, Scalar};

use super::NoResponse;
use super::drive;
use super::excitation::{Excitation, Grid};
use super::fourier::Fourier;
use super::pair::Pair;
use super::shooting;
use super::wave::Wave;
use mechanics::Mechanics;
use pass::{Pass, Precision};
use runge_kutta::{MOST_STATES, Vector};

/// Largest error of a step while the periodic motion is looked for.
const LOOSE: f64 = 1e-4;

/// The same for the motion that is reported.
const TIGHT: f64 = 2e-8;

/// Newton's steps after which the motion counts as not periodic.
const MOST_ITERATIONS: usize = 80;

/// Share of a state's size that a step may move it, where motions may not be
/// unique.
const LEASH: f64 = 0.2;

/// Change a period, as a share of a state's size, at which the motion is
/// periodic.
const CLOSED: f64 = 1e-8;

/// States and a constant torque.
type Unknowns = Dual<{ MOST_STATES + 1 }>;

/// A periodic motion: what to start a period with.
pub(super) struct Periodic {
    state: Vector<f64>,
    balance: f64,
    precision: Precision,
    /// Residuals by unknowns where they were last differentiated.
    chord: Vec<Unknowns>,
}

/// Harmonics of v, and what must vanish over a period.
pub(super) struct Followed<S> {
    pub velocity: Vec<Pair<S>>,
    pub residuals: Vec<S>,
}

/// Finds the periodic motion reached from rest; `None`: it is rest itself.
pub(super) fn periodic(axis: &Axis, wave: &Wave<f64>) -> Result<Option<Periodic>, NoResponse> {
    let mut mechanics = Mechanics::new(axis);
    let range = wave.range();
    if axis.balanced && mechanics.rests_balanced(range) {
        return Ok(None);
    }
    let sizes = mechanics.sizes(range.0.abs().max(range.1.abs()), wave.period_s);
    let mut periodic = Periodic {
        state: [0.0; MOST_STATES],
        balance: 0.0,
        precision: Precision { tolerance: LOOSE, sizes },
        chord: Vec::new(),
    };
    if axis.balanced {
        periodic.balance = mechanics.first_balance();
    }
    mechanics.balance = periodic.balance;
    let (end, largest) = periodic.from_rest(&mechanics, wave)?;
    if end == periodic.state && largest.iter().all(|size| *size == 0.0) && !axis.balanced {
        return Ok(None);
    }
    for (size, largest) in periodic.precision.sizes.iter_mut().zip(largest) {
        *size = if largest > 0.0 { largest } else { *size };
    }
    if !axis.balanced {
        periodic.state = end;
    }
    periodic.close(axis, wave, mechanics.contracts() || axis.balanced)?;
    Ok(Some(periodic))
}

impl Periodic {
    fn from_rest(
        &self,
        mechanics: &Mechanics<f64>,
        wave: &Wave<f64>,
    ) -> Result<(Vector<f64>, [f64; MOST_STATES]), NoResponse> {
        let mut pass = Pass {
            mechanics,
            wave,
            precision: &self.precision,
            sums: None,
            largest: [0.0; MOST_STATES],
        };
        let end = pass.run(&self.state).ok_or(NoResponse::NotPeriodic { periods: 1 })?;
        Ok((end, pass.largest))
    }

    /// Newton's method at loose precision until it hardly moves.
    fn close(&mut self, axis: &Axis, wave: &Wave<f64>, free: bool) -> Result<(), NoResponse> {
        let wide = axis.map(Unknowns::constant);
        let wave = wave.map(Unknowns::constant);
        let mut before = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            let Some(followed) = self.follow(&wide, &wave, None, 0) else {
                return Err(NoResponse::NotPeriodic { periods: iteration });
            };
            let step = shooting::newton_step(&followed.residuals);
            self.chord = followed.residuals;
            let longest = self.longest(axis, step.as_slice());
            let leash = if free { 4.0 } else { LEASH };
            let scale = if longest > leash { leash / longest } else { 1.0 };
            self.advance(axis, step.as_slice(), scale);
            if !longest.is_finite() {
                return Err(NoResponse::NotPeriodic { periods: iteration });
            }
            if longest < 30.0 * LOOSE || (longest < 1e-2 && longest > 0.5 * before) {
                return Ok(());
            }
            before = longest;
        }
        Err(NoResponse::NotPeriodic { periods: MOST_ITERATIONS })
    }

    /// A step's largest entry as a share of the states' sizes.
    fn longest(&self, axis: &Axis, step: &[f64]) -> f64 {
        let states = step.len() - usize::from(axis.balanced);
        let shares =
            step[..states].iter().zip(&self.precision.sizes).map(|(s, size)| (s / size).abs());
        shares.fold(0.0, |most: f64, share| if share.is_nan() { share } else { most.max(share) })
    }

    fn advance(&mut self, axis: &Axis, step: &[f64], scale: f64) {
        let states = step.len() - usize::from(axis.balanced);
        for (state, move_by) in self.state.iter_mut().zip(&step[..states]) {
            *state += scale * move_by;
        }
        if axis.balanced {
            self.balance += scale * step[states];
        }
    }

    /// Follows the motion over a period with the unknowns riding behind
    /// `parameters` lanes, adding up v if asked.
    fn follow<S: Scalar>(
        &self,
        axis: &Axis<S>,
        wave: &Wave<S>,
        sums: Option<Fourier<'_, S>>,
        parameters: usize,
    ) -> Option<Followed<S>> {
        let mut mechanics = Mechanics::new(axis);
        let unknown = |value: f64, lane: usize| {
            S::with_lanes(value, |l| f64::from(u8::from(l == parameters + lane)))
        };
        // ∫θ begins at zero: it is no unknown.
        let states = mechanics.states - usize::from(mechanics.position_integral.is_some());
        let mut start = [S::constant(0.0); MOST_STATES];
        for i in 0..states {
            start[i] = unknown(self.state[i], i);
        }
        if axis.balanced {
            mechanics.balance = unknown(self.balance, states);
        }
        if mechanics.mode_at(wave.cells[0].at(S::constant(0.0)), &start).motion
            == super::orbit::Motion::Stuck
        {
            start[mechanics::VELOCITY] = S::constant(0.0);
        }
        let mut sums = sums;
        let mut pass = Pass {
            mechanics: &mechanics,
            wave,
            precision: &self.precision,
            sums: sums.as_mut(),
            largest: [0.0; MOST_STATES],
        };
        let end = pass.run(&start)?;
        let mut residuals: Vec<S> =
            (0..states).map(|i| end[i] - unknown(self.state[i], i)).collect();
        residuals.extend(mechanics.position_integral.map(|i| end[i] * (1.0 / wave.period_s)));
        let weighted = |(k, sum): (usize, Pair<S>)| {
            let weight = super::spectrum::weight(k, wave.period_s);
            let scaled = sum.scaled(S::constant(weight));
            if k == 0 { Pair::real(scaled.re) } else { scaled }
        };
        let velocity = sums
            .map(|sums| sums.finish().into_iter().enumerate().map(weighted).collect())
            .unwrap_or_default();
        Some(Followed { velocity, residuals })
    }

    /// Harmonics of v at full precision, with derivatives by the `parameters`
    /// lanes of the axis.
    pub fn velocity<S: Scalar>(
        &mut self,
        axis: &Axis,
        with_lanes: (&Axis<S>, &Wave<S>),
        grid: &Grid,
        highest: usize,
        parameters: usize,
    ) -> Result<Followed<S>, NoResponse> {
        self.precision.tolerance = TIGHT;
        let (wide_axis, wave) = with_lanes;
        let omega = std::f64::consts::TAU / wave.period_s;
        for _ in 0..8 {
            let sums = Fourier::new(grid, omega, highest);
            let Some(followed) = self.follow(wide_axis, wave, Some(sums), parameters) else {
                break;
            };
            let values: Vec<f64> = followed.residuals.iter().map(|r| r.value()).collect();
            if self.longest(axis, &values) < CLOSED && values.iter().all(|v| v.is_finite()) {
                return Ok(followed);
            }
            self.correct(axis, &followed.residuals, parameters);
        }
        Err(NoResponse::NotPeriodic { periods: MOST_ITERATIONS })
    }

    /// One of Newton's steps, from residuals whose unknowns ride behind
    /// `parameters` lanes or, without lanes, as they were last differentiated.
    fn correct<S: Scalar>(&mut self, axis: &Axis, residuals: &[S], parameters: usize) {
        let lanes: Vec<Unknowns> = residuals
            .iter()
            .zip(&self.chord)
            .map(|(r, chord)| {
                Unknowns::with_lanes(r.value(), |lane| match S::LANES {
                    0 => chord.lane(lane),
                    _ => r.lane(parameters + lane),
                })
            })
            .collect();
        let step = shooting::newton_step(&lanes);
        self.advance(axis, step.as_slice(), 1.0);
    }
}

/// Velocity harmonics of the periodic motion.
pub(super) fn respond(
    axis: &Axis,
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    let (wave, grid) = drive::torque(axis, excitation);
    let Some(mut periodic) = periodic(axis, &wave)? else {
        return Ok(vec![Complex::new(0.0, 0.0); highest + 1]);
    };
    let followed = periodic.velocity(axis, (axis, &wave), grid, highest, 0)?;
    Ok(followed.velocity.into_iter().map(Pair::value).collect())
}

/// The same with derivatives by the first `rows` lanes of the axis.
pub(super) fn differentiate(
    axis: &Axis<Wide>,
    values: &Axis,
    excitation: &Excitation,
    highest: usize,
    rows: usize,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let (wave, _) = drive::torque(values, excitation);
    let Some(mut periodic) = periodic(values, &wave)? else {
        let zero = vec![Complex::new(0.0, 0.0); highest + 1];
        return Ok((zero.clone(), vec![zero; rows]));
    };
    let unknowns = periodic.chord.len();
    let mut run = |first: usize| match rows + unknowns {
        ..=8 => chunk::<8>(axis, values, &mut periodic, excitation, highest, first..rows),
        _ => chunk::<16>(axis, values, &mut periodic, excitation, highest, first..rows),
    };
    let (velocity, mut sensitivities) = run(0)?;
    while sensitivities.len() < rows {
        sensitivities.extend(run(sensitivities.len())?.1);
    }
    Ok((velocity, sensitivities))
}

/// As many derivatives as fit in N lanes along with the unknowns.
fn chunk<const N: usize>(
    axis: &Axis<Wide>,
    values: &Axis,
    periodic: &mut Periodic,
    excitation: &Excitation,
    highest: usize,
    rows: Range<usize>,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let count = rows.len().min(N - periodic.chord.len());
    let narrow =
        axis.map(|x: Wide| {
            Dual::<N>::with_lanes(x.value(), |lane| {
                if lane < count { x.lane(rows.start + lane) } else { 0.0 }
            })
        });
    let (wave, grid) = drive::torque(&narrow, excitation);
    let followed = periodic.velocity(values, (&narrow, &wave), grid, highest, count)?;
    let velocity = followed.velocity.iter().map(|v| v.value()).collect();
    let rows = shooting::differentiate(&followed.velocity, &followed.residuals, count);
    Ok((velocity, rows))
}
