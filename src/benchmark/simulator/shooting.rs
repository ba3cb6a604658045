//! The periodic state that is reached from rest.
//!
//! Period by period the axis approaches it, each time by a factor that a slow mode, such as
//! an overdamped spring's, brings near 1. Where many periods would be left, Newton's method
//! takes over: one period takes the state x to P(x), and x = P(x) is solved with the
//! Jacobian of P from differences. What it finds counts only if P contracts towards it, as
//! whatever is reached from rest does, and if it lies within one range of the motion.

use nalgebra::{SMatrix, SVector};

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
const CORRECTIONS: usize = 8;
/// Step of the differences, as a share of a state's range: the error of rounding (1e-14)
/// and that of the curvature are then about equally small.
const DIFFERENCE: f64 = 1e-6;
/// Periods over which the change must shrink at all.
const STALL: usize = 250;

/// The state at the beginning of a period that ends as it began, from a state of rest.
/// `float` is asked for it where a load floats: it comes to float for ever, but its
/// collisions only get rarer.
pub(super) fn settle<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    float: &impl Fn([f64; N]) -> Option<[f64; N]>,
    start: [f64; N],
    settings: &Settings,
) -> Result<[f64; N], SimulatorError> {
    let mut state = start;
    let (mut previous_change, mut waited, mut patience) = (f64::INFINITY, 0, PATIENCE);
    let mut next_float = PATIENCE;
    let (mut smallest, mut smallest_before) = (f64::INFINITY, f64::INFINITY);
    let failed = |periods, change| Err(SimulatorError::NotPeriodic { periods, change });
    for period in 1..=settings.most_periods {
        let cycle = run(state);
        let change = size(&difference(&cycle.end, &state), &cycle.largest);
        if settled(change, previous_change, settings.tolerance) {
            return Ok(cycle.end);
        }
        if !change.is_finite() {
            return failed(period, change);
        }
        waited += 1;
        let ratio = change / previous_change;
        let left = (settings.tolerance / change).ln() / ratio.ln();
        if waited >= patience && ratio < 1.0 && left > (N + PATIENCE) as f64 {
            if let Some(periodic) = newton(run, state, &cycle, settings.tolerance) {
                return Ok(periodic);
            }
            (waited, patience) = (0, 2 * patience);
        }
        if cycle.floats && period >= next_float {
            if let Some(periodic) = float(cycle.end) {
                return Ok(periodic);
            }
            next_float = 2 * period;
        }
        smallest = smallest.min(change);
        if period % STALL == 0 {
            if smallest > 0.99 * smallest_before {
                return failed(period, change);
            }
            (smallest_before, smallest) = (smallest, f64::INFINITY);
        }
        previous_change = change;
        state = cycle.end;
    }
    failed(settings.most_periods, previous_change)
}

/// Whether what is left of the transients is below the tolerance: changes that shrink
/// by a factor r a period still add up to change · r/(1 − r).
fn settled(change: f64, previous_change: f64, tolerance: f64) -> bool {
    let shrinks = change < previous_change && previous_change.is_finite();
    let left = change * change / (previous_change - change);
    // Changes of rounding size shrink no more.
    change <= 1e-3 * tolerance || (shrinks && left <= tolerance)
}

/// The periodic state near `state`, whose period is `cycle`; `None` where none is found
/// that must be the one approached.
fn newton<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    state: [f64; N],
    cycle: &Cycle<N>,
    tolerance: f64,
) -> Option<[f64; N]> {
    let mut at = state;
    let mut remaining = difference(&cycle.end, &at);
    let mut largest = cycle.largest;
    let mut solver = solver(run, at, &cycle.end, &largest)?;
    for _ in 0..CORRECTIONS {
        let correction: [f64; N] = (solver * SVector::from(remaining)).into();
        let distance = size(&correction, &largest);
        if distance > 1.0 {
            return None;
        }
        let next = std::array::from_fn(|i| at[i] + correction[i]);
        let cycle = run(next);
        let left = difference(&cycle.end, &next);
        let shrunk = size(&left, &cycle.largest) / size(&remaining, &largest);
        if distance <= tolerance && size(&left, &cycle.largest) <= tolerance {
            return Some(cycle.end);
        }
        if !(shrunk < 0.5) {
            return None;
        }
        (at, remaining, largest) = (next, left, cycle.largest);
        if shrunk > 0.02 {
            solver = self::solver(run, at, &cycle.end, &largest)?;
        }
    }
    None
}

/// (1 − P')⁻¹ at a state whose period ends at `end`; `None` where P does not contract.
fn solver<const N: usize>(
    run: &impl Fn([f64; N]) -> Cycle<N>,
    state: [f64; N],
    end: &[f64; N],
    largest: &[f64; N],
) -> Option<SMatrix<f64, N, N>> {
    let mut jacobian = SMatrix::<f64, N, N>::zeros();
    for column in 0..N {
        let step = DIFFERENCE * if largest[column] > 0.0 { largest[column] } else { 1.0 };
        let mut moved = state;
        moved[column] += step;
        let slope = difference(&run(moved).end, end).map(|change| change / step);
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
