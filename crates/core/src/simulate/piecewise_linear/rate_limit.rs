//! A rate limiter with input u and output w, in its own periodic steady state.
//!
//! w = u while |u'| ≤ rate; otherwise w' = ±rate until w meets u again. If w never follows u
//! (w ≠ u except at single instants), it is a triangle that turns where it meets u.

use crate::plant::Scalar;

use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic};
use crate::simulate::signal::root_finding::bisect;

/// Most periods until a limiter that never follows its input counts as settled.
const MOST_PERIODS: usize = 400;

/// A ramp that has just left the input is not checked for a return within this share of a cell.
const RETURN_SEARCH_OFFSET: f64 = 1e-4;

/// State of the limiter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State<S> {
    /// w = u.
    Following,
    /// w rises (+1) or falls (−1) at the rate limit, from `value` at time `from_s`.
    Ramp { sign: f64, from_s: S, value: S },
}

/// The output of a limiter of |w'| to `rate`, input units per second.
pub(crate) fn limited<S: Scalar>(forcing: &PiecewiseQuintic<S>, rate: S) -> PiecewiseQuintic<S> {
    let fastest = forcing.cells.iter().map(steepest).fold(0.0, f64::max);
    if fastest <= rate.value() {
        return forcing.clone();
    }
    // The first period depends on the start. Later ones do not if w ever follows u; a triangle
    // converges gradually.
    let start = forcing.cells[0].at(S::constant(0.0));
    let mut state = State::Following;
    if forcing.cells[0].number_slope(0.0).abs() / forcing.cells[0].length_s > rate.value() {
        let sign = forcing.cells[0].number_slope(0.0).signum();
        state = State::Ramp { sign, from_s: S::constant(0.0), value: start };
    }
    let (mut cells, _, mut end) = pass(forcing, rate, state);
    for _ in 0..MOST_PERIODS {
        let next = a_period_earlier(end, forcing.period_s);
        let settled = distance(next, state, rate.value()) <= 1e-13 * fastest * forcing.period_s;
        state = next;
        let followed;
        (cells, followed, end) = pass(forcing, rate, state);
        if !followed && let Some(triangle) = triangle(forcing, rate) {
            (cells, _, _) = pass(forcing, rate, triangle);
            break;
        }
        if settled && (followed || S::LANES == 0) {
            break;
        }
    }
    PiecewiseQuintic { cells, period_s: forcing.period_s }
}

/// The steady state at time 0 of a limiter that never follows an input with u(t + T/2) = −u(t): a
/// triangle of amplitude rate·T/4 and zero mean. `None` for other inputs.
fn triangle<S: Scalar>(forcing: &PiecewiseQuintic<S>, rate: S) -> Option<State<S>> {
    let amplitude = rate * (0.25 * forcing.period_s);
    let numbers = |time_s: f64| {
        let cell =
            forcing.cells.iter().find(|cell| time_s <= cell.end_s()).or(forcing.cells.last());
        cell.map_or(0.0, |cell| cell.number((time_s - cell.from_s) / cell.length_s))
    };
    let scale = forcing.range().1;
    let mirrored = (0..8).all(|i| {
        let time_s = forcing.period_s * f64::from(i) / 16.0;
        (numbers(time_s) + numbers(time_s + 0.5 * forcing.period_s)).abs() <= 1e-9 * scale
    });
    if !mirrored {
        return None;
    }
    // The triangle turns downwards where u falls through the amplitude.
    let (cell, u) = forcing.cells.iter().find_map(|cell| {
        (cell.number(0.0) >= amplitude.value())
            .then(|| cell.crossing(0.0, amplitude.value(), -1.0))?
            .map(|u| (cell, u))
    })?;
    let at = S::constant(u);
    let moved = (amplitude - cell.at(at)) / cell.slope(at);
    let from_s = (at + moved) * cell.length_s + cell.from_s;
    // Of the ramps, the one that began last before time 0.
    let half = 0.5 * forcing.period_s;
    Some(if from_s.value() < half {
        State::Ramp { sign: 1.0, from_s: from_s - half, value: -amplitude }
    } else {
        State::Ramp { sign: -1.0, from_s: from_s - forcing.period_s, value: amplitude }
    })
}

/// Estimate of the largest |u'| in a cell, from three positions.
fn steepest<S: Scalar>(cell: &Cell<S>) -> f64 {
    let slopes = [0.0, 0.5, 1.0].map(|u| cell.number_slope(u).abs());
    slopes.into_iter().fold(0.0, f64::max) / cell.length_s
}

fn a_period_earlier<S: Scalar>(state: State<S>, period_s: f64) -> State<S> {
    match state {
        State::Following => State::Following,
        State::Ramp { sign, from_s, value } => {
            State::Ramp { sign, from_s: from_s - period_s, value }
        }
    }
}

/// Difference of two states: of the ramps' values, extrapolated to time 0.
fn distance<S: Scalar>(a: State<S>, b: State<S>, rate: f64) -> f64 {
    match (a, b) {
        (State::Following, State::Following) => 0.0,
        (
            State::Ramp { sign, from_s, value },
            State::Ramp { sign: other, from_s: earlier, value: before },
        ) if sign == other => {
            let at_zero = |from_s: S, value: S| value.value() - sign * rate * from_s.value();
            (at_zero(from_s, value) - at_zero(earlier, before)).abs()
        }
        _ => f64::INFINITY,
    }
}

/// Simulates the limiter over one period. Returns its output, whether w ever followed u, and the
/// state at the end.
fn pass<S: Scalar>(
    forcing: &PiecewiseQuintic<S>,
    rate: S,
    mut state: State<S>,
) -> (Vec<Cell<S>>, bool, State<S>) {
    let mut cells = Vec::with_capacity(forcing.cells.len() + 8);
    let mut followed = false;
    for cell in &forcing.cells {
        let mut from = 0.0;
        // Within one cell w may follow, leave and meet u again; more changes come from rounding.
        for _ in 0..8 {
            let (to, next) = match state {
                State::Following => leaves(cell, from, rate),
                State::Ramp { sign, from_s, value } => meets(cell, from, rate, sign, from_s, value),
            };
            if to - from > 1e-12 {
                let part = cell.part(from, to);
                cells.push(match state {
                    State::Following => part,
                    State::Ramp { sign, from_s, value } => ramp(&part, rate * sign, from_s, value),
                });
                followed |= state == State::Following;
            }
            state = next.unwrap_or(state);
            from = to;
            if next.is_none() {
                break;
            }
        }
    }
    (cells, followed, state)
}

/// The ramp over the time of `part`.
fn ramp<S: Scalar>(part: &Cell<S>, slope: S, from_s: S, value: S) -> Cell<S> {
    let zero = S::constant(0.0);
    let start = value + slope * (-from_s + part.from_s);
    Cell { powers: [start, slope * part.length_s, zero, zero, zero, zero], ..*part }
}

/// The position from `from` on at which |u'| exceeds the rate, and the ramp that follows.
fn leaves<S: Scalar>(cell: &Cell<S>, from: f64, rate: S) -> (f64, Option<State<S>>) {
    let limit = rate.value() * cell.length_s;
    let slow = |u: f64| cell.number_slope(u).abs() <= limit;
    let at = if !slow(from) {
        from
    } else if let Some(fast) =
        [0.5, 1.0].map(|share| from + share * (1.0 - from)).into_iter().find(|u| !slow(*u))
    {
        bisect(from, fast, slow)
    } else {
        return (1.0, None);
    };
    let sign = cell.number_slope(at).signum();
    let u = S::constant(at);
    // There u' = ±rate, so that the derivative of this time cancels and is left out.
    let from_s = S::constant(cell.from_s + at * cell.length_s);
    (at, Some(State::Ramp { sign, from_s, value: cell.at(u) }))
}

/// The position from `from` on at which the ramp meets u, and the state after it.
fn meets<S: Scalar>(
    cell: &Cell<S>,
    from: f64,
    rate: S,
    sign: f64,
    from_s: S,
    value: S,
) -> (f64, Option<State<S>>) {
    let slope = rate * sign * cell.length_s;
    let start = value + rate * sign * (-from_s + cell.from_s);
    // w − u in the direction of the ramp: negative until they meet.
    let mut ahead = *cell;
    ahead.powers = ahead.powers.map(|power| -power * sign);
    ahead.powers[0] += start * sign;
    ahead.powers[1] += slope * sign;
    // A ramp that has just left u begins at w − u = 0: the search starts where the difference
    // exceeds rounding.
    let just_left = ahead.number(from) > -1e-13 * start.value().abs().max(slope.value().abs());
    let begin = if just_left { from + RETURN_SEARCH_OFFSET } else { from };
    if begin >= 1.0 {
        return (1.0, None);
    }
    let at = if ahead.number(begin) > 0.0 { Some(from) } else { ahead.crossing(begin, 0.0, 1.0) };
    let Some(at) = at else { return (1.0, None) };
    let u = S::constant(at);
    let u = u - ahead.at(u) / ahead.slope(u);
    let time_s = u * cell.length_s + cell.from_s;
    let rising = cell.number_slope(at) / cell.length_s;
    let next = if rising.abs() <= rate.value() {
        State::Following
    } else {
        State::Ramp { sign: rising.signum(), from_s: time_s, value: cell.at(u) }
    };
    (at, Some(next))
}
