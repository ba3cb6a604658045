//! The periodic state that is reached from rest.
//!
//! Period by period the axis approaches it, each time by a factor that a slow mode, such as
//! an overdamped spring's, brings near 1. Where many periods would be left, Newton's method
//! takes over: one period takes the state x to P(x), and x = P(x) is solved with the
//! Jacobian of P from differences. What it finds counts only if P contracts towards it, as
//! whatever is reached from rest does.

use nalgebra::{SMatrix, SVector};

use super::mechanics::VELOCITY;
use super::{Settings, SimulatorError};

/// One period of a motion.
pub(super) struct Cycle<const N: usize> {
    /// State at its end.
    pub(super) end: [f64; N],
    /// Largest size of each state within it.
    pub(super) largest: [f64; N],
    /// Whether a load floated within its gap all the time.
    pub(super) floats: bool,
}

/// Periods before Newton's method is tried; twice as many after each failure.
const PATIENCE: usize = 4;
/// Corrections by Newton's method before it counts as failed.
const CORRECTIONS: usize = 40;
/// Longest leap, as a share of the motion's range: farther ones might reach another response
/// than the one that is approached.
const FARTHEST: f64 = 0.5;
/// Smallest share of a correction that is tried.
const SMALLEST_SHARE: f64 = 0.01;
/// An axis rests whose velocity is below this share of what the input might bring about.
const AT_REST: f64 = 1e-8;
/// The same where no method gets any further: it falls as the square root of the cubed
/// distance from where the axis sticks, and that distance as 1/periods.
const CREEP: f64 = 1e-5;
/// Step of the differences, as a share of a state's range: the error of rounding (1e-14)
/// and that of the curvature are then about equally small.
const DIFFERENCE: f64 = 1e-6;
/// Periods over which the change must shrink at all.
const STALL: usize = 250;

/// How the periodic state is looked for.
pub(super) struct Search<'a> {
    pub(super) settings: &'a Settings,
    /// A velocity that the input might bring about without friction.
    pub(super) speed: f64,
}

/// The state at the beginning of a period that ends as it began, from a state of rest;
/// `None` where the axis comes to rest: against a spring it may creep ever more slowly
/// towards where it sticks, without ever getting there.
///
/// `float` is asked for the state where a load floats: it comes to float for ever, but its
/// collisions only get rarer.
pub(super) fn settle<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    float: &impl Fn([f64; N]) -> Option<[f64; N]>,
    start: [f64; N],
    search: &Search,
) -> Result<Option<[f64; N]>, SimulatorError> {
    let Search { settings, speed } = *search;
    let mut state = start;
    let (mut previous_change, mut waited, mut patience) = (f64::INFINITY, 0, PATIENCE);
    let mut next_float = PATIENCE;
    let (mut smallest, mut smallest_before) = (f64::INFINITY, f64::INFINITY);
    let failed = |periods, change| Err(SimulatorError::NotPeriodic { periods, change });
    let mut creeps = false;
    for period in 1..=settings.most_periods {
        let cycle = run(state);
        let change = size(&difference(&cycle.end, &state), &cycle.largest);
        if settled(change, previous_change, settings.tolerance) {
            return Ok(Some(cycle.end));
        }
        if !change.is_finite() {
            return failed(period, change);
        }
        creeps = cycle.largest[VELOCITY] <= CREEP * speed;
        if is_at_rest(&cycle, speed) && change <= AT_REST {
            return Ok(None);
        }
        waited += 1;
        let ratio = change / previous_change;
        let left = (settings.tolerance / change).ln() / ratio.ln();
        if waited >= patience && ratio < 1.0 && left > (N + PATIENCE) as f64 {
            let found = newton(run, state, cycle, search);
            match found {
                Leap::Periodic(periodic) => return Ok(Some(periodic)),
                Leap::AtRest => return Ok(None),
                Leap::Nearer(nearer) => {
                    state = nearer;
                    (waited, patience) = (0, 2 * patience);
                    previous_change = f64::INFINITY;
                    continue;
                }
            }
        }
        if cycle.floats && period >= next_float {
            if let Some(periodic) = float(cycle.end) {
                return Ok(Some(periodic));
            }
            next_float = 2 * period;
        }
        smallest = smallest.min(change);
        if period % STALL == 0 {
            if smallest > 0.99 * smallest_before {
                return if creeps { Ok(None) } else { failed(period, change) };
            }
            (smallest_before, smallest) = (smallest, f64::INFINITY);
        }
        previous_change = change;
        state = cycle.end;
    }
    if creeps { Ok(None) } else { failed(settings.most_periods, previous_change) }
}

fn is_at_rest<const N: usize>(cycle: &Cycle<N>, speed: f64) -> bool {
    cycle.largest[VELOCITY] <= AT_REST * speed
}

/// Whether what is left of the transients is below the tolerance: changes that shrink
/// by a factor r a period still add up to change · r/(1 − r).
fn settled(change: f64, previous_change: f64, tolerance: f64) -> bool {
    let shrinks = change < previous_change && previous_change.is_finite();
    let left = change * change / (previous_change - change);
    // Changes of rounding size shrink no more.
    change <= 1e-3 * tolerance || (shrinks && left <= tolerance)
}

/// Where Newton's method ends.
enum Leap<const N: usize> {
    /// At the periodic state.
    Periodic([f64; N]),
    /// Where the axis all but sticks.
    AtRest,
    /// Where it gets no further.
    Nearer([f64; N]),
}

/// Leaps from `state`, whose period is `cycle`, towards the periodic state.
fn newton<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    mut state: [f64; N],
    mut cycle: Cycle<N>,
    search: &Search,
) -> Leap<N> {
    let tolerance = search.settings.tolerance;
    let mut inverse = None;
    for _ in 0..CORRECTIONS {
        let remaining = difference(&cycle.end, &state);
        let before = size(&remaining, &cycle.largest);
        let solver = inverse.take().or_else(|| solver(run, state, &cycle));
        let Some(solver) = solver else { return Leap::Nearer(cycle.end) };
        let correction: [f64; N] = (solver * SVector::from(remaining)).into();
        let distance = size(&correction, &cycle.largest);
        let mut share = (FARTHEST / distance).min(1.0);
        let (next, next_cycle, after) = loop {
            let next = std::array::from_fn(|i| state[i] + share * correction[i]);
            let next_cycle = run(next);
            let after = size(&difference(&next_cycle.end, &next), &next_cycle.largest);
            if distance <= tolerance && after <= tolerance {
                return Leap::Periodic(next_cycle.end);
            }
            if after < (1.0 - 0.2 * share) * before {
                break (next, next_cycle, after);
            }
            share *= 0.25;
            if share < SMALLEST_SHARE {
                return Leap::Nearer(cycle.end);
            }
        };
        (state, cycle) = (next, next_cycle);
        if is_at_rest(&cycle, search.speed) && after <= AT_REST {
            return Leap::AtRest;
        }
        if after < 0.02 * before {
            inverse = Some(solver);
        }
    }
    Leap::Nearer(cycle.end)
}

/// (1 − P')⁻¹ at a state whose period is `cycle`; `None` where P does not contract.
fn solver<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    state: [f64; N],
    cycle: &Cycle<N>,
) -> Option<SMatrix<f64, N, N>> {
    let mut jacobian = SMatrix::<f64, N, N>::zeros();
    for column in 0..N {
        let range = if cycle.largest[column] > 0.0 { cycle.largest[column] } else { 1.0 };
        // Back to where the motion comes from: ahead it might stick.
        let step = -(DIFFERENCE * range).copysign(cycle.end[column] - state[column]);
        let mut moved = state;
        moved[column] += step;
        let slope = difference(&run(moved).end, &cycle.end).map(|change| change / step);
        jacobian.set_column(column, &SVector::from(slope));
    }
    contracts(&jacobian).then(|| (SMatrix::identity() - jacobian).try_inverse()).flatten()
}

/// Whether the powers of a matrix vanish: 2¹⁶ periods, by squaring.
fn contracts<const N: usize>(jacobian: &SMatrix<f64, N, N>) -> bool {
    let mut power = *jacobian;
    for _ in 0..16 {
        if power.iter().any(|entry| !entry.is_finite()) {
            return false;
        }
        power *= power;
    }
    power.iter().all(|entry| entry.is_finite()) && power.norm() < 0.5
}

fn difference<const N: usize>(left: &[f64; N], right: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| left[i] - right[i])
}

/// Largest share of a state's range; a state that never moved has none.
fn size<const N: usize>(change: &[f64; N], largest: &[f64; N]) -> f64 {
    let share = |i: usize| if largest[i] > 0.0 { change[i].abs() / largest[i] } else { 0.0 };
    (0..N).map(share).fold(0.0, f64::max)
}
