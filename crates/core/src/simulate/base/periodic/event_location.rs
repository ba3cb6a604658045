//! Event location: the time within a cell of the grid at which the axis stops or breaks away.

use super::{Anchor, AxisOnGrid, RELATIVE_ROUNDING};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::signal::root_finding::{bisect, newton, root};

/// Newton's method stops after a step shorter than this share of the interval searched: the error
/// left is of the order of the step squared.
const NEWTON_TOLERANCE: f64 = 1e-8;

impl AxisOnGrid<'_> {
    /// The first time from `from_s` on, within the cell, at which the torque exceeds a static
    /// level, and the direction in which the axis then moves.
    pub(crate) fn breakaway(&self, cell: usize, from_s: f64) -> Option<(f64, Motion)> {
        let sampled = self.sampled;
        let (plus, minus) = (self.friction.fs_plus, self.friction.fs_minus);
        let direction = |torque: f64| match torque {
            t if t > plus => Some(Motion::Forward),
            t if t < -minus => Some(Motion::Backward),
            _ => None,
        };
        // Usually the search begins at the start of the cell, where the torque is known.
        let whole_cell = from_s <= sampled.time(cell);
        let start = if whole_cell { sampled.node(cell).0 } else { sampled.torque(cell, from_s).0 };
        if let Some(motion) = direction(start) {
            return Some((from_s, motion));
        }
        let (low, mut high) = (from_s, sampled.time(cell + 1));
        let length_s = high - low;
        let motion = match direction(sampled.node(cell + 1).0) {
            Some(motion) => motion,
            None => {
                high = self.torque_extremum(cell, from_s)?;
                direction(sampled.torque(cell, high).0)?
            }
        };
        let (sign, level) = if motion == Motion::Forward { (1.0, plus) } else { (-1.0, -minus) };
        let excess = |time_s: f64| {
            let (torque, rate) = sampled.torque(cell, time_s);
            (sign * (torque - level), sign * rate)
        };
        let time_s = rising_root([low, high], 0.5 * (low + high), length_s, excess);
        Some((time_s, motion))
    }

    /// The time of an extremum of the torque within the cell. `None` if there is none, or if the
    /// tangent at the end of the cell shows that the torque stays below the static level.
    fn torque_extremum(&self, cell: usize, from_s: f64) -> Option<f64> {
        let sampled = self.sampled;
        let end_s = sampled.time(cell + 1);
        let rate_end = sampled.rate_at_end(cell);
        let sign = -rate_end.signum();
        let level = if sign > 0.0 { self.friction.fs_plus } else { self.friction.fs_minus };
        let reach = sign * sampled.node(cell + 1).0 + rate_end.abs() * (end_s - from_s);
        if reach <= level {
            return None;
        }
        let rises = |time_s: f64| sign * sampled.torque(cell, time_s).1 > 0.0;
        rises(from_s).then(|| bisect(from_s, end_s, rises))
    }

    /// The time within the cell at which a slide ends, and the motion that follows. `x_end` is x at
    /// the end of the cell if the slide goes on.
    pub(crate) fn stop(
        &self,
        cell: usize,
        anchor: Anchor,
        friction: f64,
        motion: Motion,
        x_end: f64,
    ) -> Option<(f64, Motion)> {
        let sampled = self.sampled;
        let sign = if motion == Motion::Forward { 1.0 } else { -1.0 };
        let cell_end = sampled.time(cell + 1);
        let (starts_whole, torque_end) =
            (anchor.time_s <= sampled.time(cell), sampled.node(cell + 1).0);
        let torque_start =
            if starts_whole { sampled.node(cell).0 } else { sampled.torque(cell, anchor.time_s).0 };
        let rate_start = sign * (-self.a * anchor.x + torque_start - friction);
        let rate_end = sign * (-self.a * x_end + torque_end - friction);
        // x and x', with the sign that makes x positive during the slide.
        let offset = friction / self.a;
        let x = |time_s: f64| {
            let (torque, steady) = sampled.both(cell, time_s);
            let kept = (-self.a * (time_s - anchor.time_s)).exp();
            let x = steady - offset + (anchor.x - anchor.steady + offset) * kept;
            (sign * x, sign * (-self.a * x + torque - friction))
        };
        // A slide that began within the cell starts at x = 0, and rounding may give x the wrong
        // sign at first. A stop found there would be followed by a breakaway at the same time,
        // without end.
        let fresh = anchor.x == 0.0;
        let crosses = sign * x_end < if fresh { -RELATIVE_ROUNDING * self.scale } else { 0.0 };
        let (mut low, mut high) = (anchor.time_s, cell_end);
        let length_s = high - low;
        let first = if crosses && fresh && rate_start > 0.0 {
            // x rises from zero and returns to it within the cell: search after its maximum.
            low = bisect(low, high, |t| x(t).1 > 0.0);
            0.5 * (low + high)
        } else if crosses {
            // Newton's method starts at the zero of the cubic through values and slopes at both
            // ends.
            let (y, d) = (sign * anchor.x, rate_start * length_s);
            let value = sign * x_end - y - d;
            let slope = rate_end * length_s - d;
            let (square, cube) = (3.0 * value - slope, slope - 2.0 * value);
            let fallen = |u: f64| -(((cube * u + square) * u + d) * u + y);
            let falls = |u: f64| -((3.0 * cube * u + 2.0 * square) * u + d);
            low + length_s * root(0.0, 1.0, fallen, falls)
        } else {
            // x may fall below zero between two nodes, but only if its tangent does.
            let within_reach = sign * anchor.x + rate_start * length_s < 0.0;
            if fresh || !(rate_start < 0.0 && rate_end > 0.0 && within_reach) {
                return None;
            }
            high = bisect(low, high, |t| x(t).1 < 0.0);
            if x(high).0 >= 0.0 {
                return None;
            }
            0.5 * (low + high)
        };
        let fallen = |time_s: f64| {
            let (x, rate) = x(time_s);
            (-x, -rate)
        };
        let time_s = rising_root([low, high], first, length_s, fallen);
        let torque = sampled.torque(cell, time_s).0;
        let next = match motion {
            Motion::Forward if torque < -self.friction.fs_minus => Motion::Backward,
            Motion::Backward if torque > self.friction.fs_plus => Motion::Forward,
            _ => Motion::Stuck,
        };
        Some((time_s, next))
    }
}

/// The time between `low` and `high` at which a signal rises through zero, by Newton's method from
/// `first`. `rising` returns the signal and its rate; the tolerance is relative to `length_s`.
fn rising_root(
    [low, high]: [f64; 2],
    first: f64,
    length_s: f64,
    rising: impl Fn(f64) -> (f64, f64),
) -> f64 {
    newton([low, high], first, 60, rising, |step| step.length <= NEWTON_TOLERANCE * length_s)
}
