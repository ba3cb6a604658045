//! Event location: the times within a cell at which the axis stops or breaks away.

use super::{Anchor, Followed, ROUNDING};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::signal::root_finding::{bisect, newton, root};

/// Share of a cell that Newton's step may move an instant at last: its error
/// after the step is of the order of the step squared.
const LAST_STEP: f64 = 1e-8;

impl Followed<'_> {
    /// The instant within the cell at which the torque exceeds a static level.
    pub(crate) fn breakaway(&self, cell: usize, from_s: f64) -> Option<(f64, Motion)> {
        let course = self.course;
        let (plus, minus) = (self.friction.fs_plus, self.friction.fs_minus);
        let direction = |torque: f64| match torque {
            t if t > plus => Some(Motion::Forward),
            t if t < -minus => Some(Motion::Backward),
            _ => None,
        };
        // Most cells are asked for their start alone.
        let whole_cell = from_s <= course.time(cell);
        let start = if whole_cell { course.node(cell).0 } else { course.torque(cell, from_s).0 };
        if let Some(motion) = direction(start) {
            return Some((from_s, motion));
        }
        let (low, mut high) = (from_s, course.time(cell + 1));
        let length_s = high - low;
        let motion = match direction(course.node(cell + 1).0) {
            Some(motion) => motion,
            None => {
                high = self.top(cell, from_s)?;
                direction(course.torque(cell, high).0)?
            }
        };
        let (sign, level) = if motion == Motion::Forward { (1.0, plus) } else { (-1.0, -minus) };
        let excess = |time_s: f64| {
            let (torque, rate) = course.torque(cell, time_s);
            (sign * (torque - level), sign * rate)
        };
        let time_s = passing([low, high], 0.5 * (low + high), length_s, excess);
        Some((time_s, motion))
    }

    /// The instant within the cell at which the torque turns back, where its
    /// tangent at the end lets it exceed a static level between two nodes.
    fn top(&self, cell: usize, from_s: f64) -> Option<f64> {
        let course = self.course;
        let end_s = course.time(cell + 1);
        let rate_end = course.rate_at_end(cell);
        let sign = -rate_end.signum();
        let level = if sign > 0.0 { self.friction.fs_plus } else { self.friction.fs_minus };
        let reach = sign * course.node(cell + 1).0 + rate_end.abs() * (end_s - from_s);
        if reach <= level {
            return None;
        }
        let rises = |time_s: f64| sign * course.torque(cell, time_s).1 > 0.0;
        rises(from_s).then(|| bisect(from_s, end_s, rises))
    }

    /// The instant within the cell at which a slide ends, and what follows.
    pub(crate) fn stop(
        &self,
        cell: usize,
        anchor: Anchor,
        friction: f64,
        motion: Motion,
        x_end: f64,
    ) -> Option<(f64, Motion)> {
        let course = self.course;
        let sign = if motion == Motion::Forward { 1.0 } else { -1.0 };
        let cell_end = course.time(cell + 1);
        let (starts_whole, torque_end) =
            (anchor.time_s <= course.time(cell), course.node(cell + 1).0);
        let torque_start =
            if starts_whole { course.node(cell).0 } else { course.torque(cell, anchor.time_s).0 };
        let rate_start = sign * (-self.a * anchor.x + torque_start - friction);
        let rate_end = sign * (-self.a * x_end + torque_end - friction);
        // x and x', both positive in the direction of the slide.
        let offset = friction / self.a;
        let x = |time_s: f64| {
            let (torque, steady) = course.both(cell, time_s);
            let kept = (-self.a * (time_s - anchor.time_s)).exp();
            let x = steady - offset + (anchor.x - anchor.steady + offset) * kept;
            (sign * x, sign * (-self.a * x + torque - friction))
        };
        // A slide that began within the cell leaves zero, whatever rounding makes of
        // its first instants: a stop there would be a breakaway again, for ever.
        let fresh = anchor.x == 0.0;
        let crosses = sign * x_end < if fresh { -ROUNDING * self.scale } else { 0.0 };
        let (mut low, mut high) = (anchor.time_s, cell_end);
        let length_s = high - low;
        let first = if crosses && fresh && rate_start > 0.0 {
            // It leaves zero and returns to it within the cell: look beyond the top.
            low = bisect(low, high, |t| x(t).1 > 0.0);
            0.5 * (low + high)
        } else if crosses {
            // Begin where the cubic through values and slopes of both ends meets zero.
            let (y, d) = (sign * anchor.x, rate_start * length_s);
            let value = sign * x_end - y - d;
            let slope = rate_end * length_s - d;
            let (square, cube) = (3.0 * value - slope, slope - 2.0 * value);
            let fallen = |u: f64| -(((cube * u + square) * u + d) * u + y);
            let falls = |u: f64| -((3.0 * cube * u + 2.0 * square) * u + d);
            low + length_s * root(0.0, 1.0, fallen, falls)
        } else {
            // It may dip below zero between two nodes, if its tangent does.
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
        let time_s = passing([low, high], first, length_s, fallen);
        let torque = course.torque(cell, time_s).0;
        let next = match motion {
            Motion::Forward if torque < -self.friction.fs_minus => Motion::Backward,
            Motion::Backward if torque > self.friction.fs_plus => Motion::Forward,
            _ => Motion::Stuck,
        };
        Some((time_s, next))
    }
}

/// Where what rises through zero between two instants does so, by Newton's method from `first`
/// within that bracket. `rising` gives its value and rate; `length_s` is what the last step is
/// measured by.
fn passing(
    [low, high]: [f64; 2],
    first: f64,
    length_s: f64,
    rising: impl Fn(f64) -> (f64, f64),
) -> f64 {
    newton([low, high], first, 60, rising, |step| step.length <= LAST_STEP * length_s)
}
