//! The periodic state that is reached from rest, by simulation and Newton's method (shooting).
//!
//! The axis is simulated period by period. A slow mode, such as that of an overdamped spring, can
//! make it converge very slowly. If many more periods would be needed, Newton's method solves
//! x = P(x), where P is the return map over one period and its Jacobian comes from finite
//! differences. A solution is accepted only if P contracts towards it, because an unstable periodic
//! motion is never reached from rest.

use nalgebra::{SMatrix, SVector};

use super::mechanics::VELOCITY;
use super::{Settings, SimulatorError};

/// One period of a motion.
pub(super) struct Cycle<const N: usize> {
    /// State at its end.
    pub(super) end: [f64; N],
    /// Largest absolute value of each state within it.
    pub(super) largest: [f64; N],
    /// Whether the load stayed inside its gap for the whole period.
    pub(super) floats: bool,
}

/// Periods simulated before Newton's method is tried; doubled after each failure.
const PERIODS_BEFORE_NEWTON: usize = 4;
/// Most corrections of one attempt of Newton's method.
const CORRECTIONS: usize = 40;
/// Longest Newton step, as a share of the motion's range. A longer one might reach another periodic
/// response than the one that is approached.
const LONGEST_STEP: f64 = 0.5;
/// Smallest share of a Newton correction that is tried.
const SMALLEST_SHARE: f64 = 0.01;
/// The axis is at rest if its velocity, and the change of its state over a period, are below this
/// share of [`Search::speed`] and of the state's range.
const REST_LIMIT: f64 = 1e-8;
/// Speed limit, as a share of [`Search::speed`], below which an axis that does not converge counts
/// as creeping to rest. It is larger because such an axis slows down only gradually: its velocity
/// is proportional to the distance to the sticking position to the power 3/2, and that distance to
/// 1/periods.
const CREEP_SPEED_LIMIT: f64 = 1e-5;
/// Step of the finite differences, as a share of a state's range. Rounding errors (1e-14) and the
/// error from curvature are then about equally small.
const DIFFERENCE_STEP: f64 = 1e-6;
/// The smallest change must have decreased by 1 % after this many periods.
const STALL_PERIODS: usize = 250;

/// Settings of the search for the periodic state.
pub(super) struct Search<'a> {
    pub(super) settings: &'a Settings,
    /// An upper bound on the velocity without friction, response units.
    pub(super) speed: f64,
}

/// The state at the beginning of a period of the periodic motion reached from `start`.
///
/// `None` if the axis comes to rest. Against a spring it may creep ever more slowly towards the
/// sticking position without reaching it.
///
/// `float` computes the periodic state with a floating load, which simulation approaches without
/// ever reaching it (see the module `floating`).
pub(super) fn settle<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    float: &impl Fn([f64; N]) -> Option<[f64; N]>,
    start: [f64; N],
    search: &Search,
) -> Result<Option<[f64; N]>, SimulatorError> {
    let Search { settings, speed } = *search;
    let mut state = start;
    let (mut previous_change, mut waited, mut patience) = (f64::INFINITY, 0, PERIODS_BEFORE_NEWTON);
    let mut next_float = PERIODS_BEFORE_NEWTON;
    let (mut smallest, mut smallest_before) = (f64::INFINITY, f64::INFINITY);
    let failed = |periods, change| Err(SimulatorError::NotPeriodic { periods, change });
    let mut creeps = false;
    for period in 1..=settings.most_periods {
        let cycle = run(state);
        let change = relative_size(&difference(&cycle.end, &state), &cycle.largest);
        if settled(change, previous_change, settings.tolerance) {
            return Ok(Some(cycle.end));
        }
        if !change.is_finite() {
            return failed(period, change);
        }
        creeps = cycle.largest[VELOCITY] <= CREEP_SPEED_LIMIT * speed;
        if is_at_rest(&cycle, speed) && change <= REST_LIMIT {
            return Ok(None);
        }
        waited += 1;
        let ratio = change / previous_change;
        let left = (settings.tolerance / change).ln() / ratio.ln();
        if waited >= patience && ratio < 1.0 && left > (N + PERIODS_BEFORE_NEWTON) as f64 {
            let found = newton(run, state, cycle, search);
            match found {
                NewtonResult::Periodic(periodic) => return Ok(Some(periodic)),
                NewtonResult::AtRest => return Ok(None),
                NewtonResult::NotConverged(last) => {
                    state = last;
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
        if period % STALL_PERIODS == 0 {
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
    cycle.largest[VELOCITY] <= REST_LIMIT * speed
}

/// Whether the remaining transient is below the tolerance. If the change shrinks by a factor r per
/// period, the changes still to come add up to change·r/(1 − r).
fn settled(change: f64, previous_change: f64, tolerance: f64) -> bool {
    let shrinks = change < previous_change && previous_change.is_finite();
    let left = change * change / (previous_change - change);
    // Changes of the size of rounding errors do not shrink further.
    change <= 1e-3 * tolerance || (shrinks && left <= tolerance)
}

/// Result of Newton's method.
enum NewtonResult<const N: usize> {
    /// The periodic state.
    Periodic([f64; N]),
    /// The axis is practically at rest.
    AtRest,
    /// No convergence; the last state.
    NotConverged([f64; N]),
}

/// Damped Newton's method for x = P(x) from `state`, where `cycle` is the period simulated from it.
/// The Jacobian is kept while it makes the residual shrink quickly.
fn newton<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    mut state: [f64; N],
    mut cycle: Cycle<N>,
    search: &Search,
) -> NewtonResult<N> {
    let tolerance = search.settings.tolerance;
    let mut inverse = None;
    for _ in 0..CORRECTIONS {
        let remaining = difference(&cycle.end, &state);
        let before = relative_size(&remaining, &cycle.largest);
        let solver = inverse.take().or_else(|| solver(run, state, &cycle));
        let Some(solver) = solver else { return NewtonResult::NotConverged(cycle.end) };
        let correction: [f64; N] = (solver * SVector::from(remaining)).into();
        let distance = relative_size(&correction, &cycle.largest);
        let mut share = (LONGEST_STEP / distance).min(1.0);
        let (next, next_cycle, after) = loop {
            let next = std::array::from_fn(|i| state[i] + share * correction[i]);
            let next_cycle = run(next);
            let after = relative_size(&difference(&next_cycle.end, &next), &next_cycle.largest);
            if distance <= tolerance && after <= tolerance {
                return NewtonResult::Periodic(next_cycle.end);
            }
            if after < (1.0 - 0.2 * share) * before {
                break (next, next_cycle, after);
            }
            share *= 0.25;
            if share < SMALLEST_SHARE {
                return NewtonResult::NotConverged(cycle.end);
            }
        };
        (state, cycle) = (next, next_cycle);
        if is_at_rest(&cycle, search.speed) && after <= REST_LIMIT {
            return NewtonResult::AtRest;
        }
        if after < 0.02 * before {
            inverse = Some(solver);
        }
    }
    NewtonResult::NotConverged(cycle.end)
}

/// (1 − P')⁻¹ at a state whose period is `cycle`; `None` if P does not contract.
fn solver<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    state: [f64; N],
    cycle: &Cycle<N>,
) -> Option<SMatrix<f64, N, N>> {
    let mut jacobian = SMatrix::<f64, N, N>::zeros();
    for column in 0..N {
        let range = if cycle.largest[column] > 0.0 { cycle.largest[column] } else { 1.0 };
        // Step against the direction of the motion, since the axis might stick further ahead.
        let step = -(DIFFERENCE_STEP * range).copysign(cycle.end[column] - state[column]);
        let mut moved = state;
        moved[column] += step;
        let slope = difference(&run(moved).end, &cycle.end).map(|change| change / step);
        jacobian.set_column(column, &SVector::from(slope));
    }
    contracts(&jacobian).then(|| (SMatrix::identity() - jacobian).try_inverse()).flatten()
}

/// Whether the powers of the Jacobian vanish, i.e. all Floquet multipliers are inside the unit
/// circle: computes its power 2¹⁶ by repeated squaring.
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

/// Largest change of any state, as a share of its range; a state that is always 0 counts as 0.
fn relative_size<const N: usize>(change: &[f64; N], largest: &[f64; N]) -> f64 {
    let share = |i: usize| if largest[i] > 0.0 { change[i].abs() / largest[i] } else { 0.0 };
    (0..N).map(share).fold(0.0, f64::max)
}
