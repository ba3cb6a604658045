//! Motion under any periodic torque.
//!
//! Torque τ and the steady response w of 1/(s + a) to it come in cells
//! ([`Course`]): of a general input by FFT on a uniform grid (`samples`), of a bent
//! cosine in closed form. While the axis slides, x = w − σ/a + C·exp(−a·t), so one
//! pass over the cells finds those in which the motion switches, and a bracketed
//! Newton's method on x finds the instant. The pass is linear in cells and in
//! switches. Periods follow one another from rest; the state at their start
//! converges by Newton's method on the return map, whose slope the pass gives
//! along the way.

use crate::measurement::Complex;
use crate::plant::{Friction, Plant};

use super::NoResponse;
use super::excitation::{Excitation, Grid};
use super::orbit::{Motion, Orbit, Phase};
use super::samples::{Samples, quintic_at};
use super::spectrum::sliding_friction;
use super::wave::{bisect, root};

/// Periods after which a motion from rest counts as not periodic.
const MOST_PERIODS: usize = 400;

/// Share of the largest x that is lost in rounding.
const ROUNDING: f64 = 1e-13;

/// Share of a cell that Newton's step may move an instant at last: its error
/// after the step is of the order of the step squared.
const LAST_STEP: f64 = 1e-8;

/// Switches of one cell beyond which time has stopped passing.
const MOST_SWITCHES_PER_CELL: usize = 64;

/// Torque τ and the steady response w of 1/(s + a) to it, divided into cells.
///
/// Within a cell both are smooth, and so short are the cells that a signal which
/// meets a level twice within one shows that in its slopes at both ends.
pub(super) trait Course {
    /// Cells of the period.
    fn cells(&self) -> usize;

    /// Where cell n begins, or n − 1 ends, seconds.
    fn time(&self, n: usize) -> f64;

    /// exp(−ah) over the length h of a cell.
    fn kept(&self, cell: usize) -> f64;

    /// τ and w where cell n begins, or n − 1 ends.
    fn node(&self, n: usize) -> (f64, f64);

    /// τ' at the end of a cell.
    fn rate_at_end(&self, cell: usize) -> f64;

    /// τ and τ' within a cell.
    fn torque(&self, cell: usize, time_s: f64) -> (f64, f64);

    /// τ and w within a cell.
    fn both(&self, cell: usize, time_s: f64) -> (f64, f64);
}

/// The motion reached from rest under a general input, and the torque it was
/// found with; `lines` are the torque lines.
pub(super) fn orbit(
    plant: &Plant,
    lines: &[Complex],
    excitation: &Excitation,
    grid: &Grid,
) -> Result<(Orbit, Samples), NoResponse> {
    let waves = Waves::new(plant, lines, excitation, grid);
    let orbit = follow(plant, &waves, excitation.period_s())?;
    Ok((orbit, waves.torque))
}

/// The motion reached from rest.
pub(super) fn follow(
    plant: &Plant,
    course: &impl Course,
    period_s: f64,
) -> Result<Orbit, NoResponse> {
    let scale = (0..course.cells()).fold(0.0, |most: f64, n| most.max(course.node(n).1.abs()));
    let friction = plant.friction;
    let motion = Followed { a: plant.viscous_rate_rad_s, friction, course, scale };
    let unique = friction.fs_plus == friction.fc_plus && friction.fs_minus == friction.fc_minus;
    let mut start = State { x: 0.0, motion: Motion::Stuck };
    for period in 0..MOST_PERIODS {
        let pass = motion.pass(start).ok_or(NoResponse::NotPeriodic { periods: period })?;
        let change = pass.end.x - start.x;
        // `start` of the first pass is a guess (rest), never part of the motion.
        if period > 0 && pass.end.motion == start.motion && change.abs() <= ROUNDING * scale {
            return Ok(pass.into_orbit(period_s));
        }
        // Newton's step may only jump where every start leads to the same motion.
        let jump = unique || change.abs() < 1e-3 * scale;
        let next = start.x + change / (1.0 - pass.slope);
        let same_side = match pass.end.motion {
            Motion::Forward => next > 0.0,
            Motion::Backward => next < 0.0,
            Motion::Stuck => false,
        };
        start = pass.end;
        if period > 0 && jump && same_side && pass.slope != 0.0 {
            start.x = next;
        }
    }
    Err(NoResponse::NotPeriodic { periods: MOST_PERIODS })
}

/// State of the axis: x = v/K, and what it does.
#[derive(Clone, Copy)]
struct State {
    x: f64,
    motion: Motion,
}

/// What one pass over a period found.
struct Pass {
    phases: Vec<Phase>,
    end: State,
    /// Derivative of the final x by the initial one.
    slope: f64,
}

impl Pass {
    fn into_orbit(self, period_s: f64) -> Orbit {
        if self.phases.is_empty() {
            Orbit::constant(period_s, self.end.motion)
        } else {
            Orbit { period_s, phases: self.phases }
        }
    }
}

/// Torque and steady response on the grid.
struct Waves {
    a: f64,
    torque: Samples,
    /// w: steady response of 1/(s + a) to the torque.
    steady: Vec<f64>,
    /// exp(−ah) over a cell.
    kept: f64,
}

impl Waves {
    fn new(plant: &Plant, lines: &[Complex], excitation: &Excitation, grid: &Grid) -> Self {
        let omega = excitation.omega_rad_s();
        let a = plant.viscous_rate_rad_s;
        let through: Vec<Complex> = lines
            .iter()
            .enumerate()
            .map(|(l, torque)| torque / Complex::new(a, l as f64 * omega))
            .collect();
        let (torque, steady) = Samples::of(grid, omega, lines, &through);
        let kept = (-a * torque.step_s).exp();
        Self { a, torque, steady, kept }
    }
}

impl Course for Waves {
    fn cells(&self) -> usize {
        self.torque.cells()
    }

    fn time(&self, n: usize) -> f64 {
        n as f64 * self.torque.step_s
    }

    fn kept(&self, _cell: usize) -> f64 {
        self.kept
    }

    fn node(&self, n: usize) -> (f64, f64) {
        (self.torque.value[n], self.steady[n])
    }

    fn rate_at_end(&self, cell: usize) -> f64 {
        self.torque.first[cell + 1]
    }

    fn torque(&self, cell: usize, time_s: f64) -> (f64, f64) {
        (self.torque.at(cell, time_s), self.torque.slope_at(cell, time_s))
    }

    /// w by the quintic through values and two derivatives, which w' = −a·w + τ
    /// gives exactly.
    fn both(&self, cell: usize, time_s: f64) -> (f64, f64) {
        let h = self.torque.step_s;
        let end = |n: usize| {
            let first = self.torque.value[n] - self.a * self.steady[n];
            let second = self.torque.first[n] - self.a * first;
            [self.steady[n], h * first, h * h * second]
        };
        let steady = quintic_at(end(cell), end(cell + 1), time_s / h - cell as f64);
        (self.torque.at(cell, time_s), steady)
    }
}

/// A motion under the torque of a course.
struct Followed<'a, C> {
    a: f64,
    friction: Friction,
    course: &'a C,
    /// Largest |w|.
    scale: f64,
}

/// A point of the motion from which x is continued.
#[derive(Clone, Copy)]
struct Anchor {
    time_s: f64,
    x: f64,
    steady: f64,
}

impl<C: Course> Followed<'_, C> {
    /// Follows the motion over one period; `None` where it switches without end.
    fn pass(&self, start: State) -> Option<Pass> {
        let course = self.course;
        let mut phases = Vec::new();
        let mut slope = 1.0;
        let mut state = start;
        let mut anchor = Anchor { time_s: 0.0, x: start.x, steady: course.node(0).1 };
        // Instant and torque of the last switch.
        let mut last: Option<(f64, f64)> = None;
        for cell in 0..course.cells() {
            let cell_end = course.time(cell + 1);
            let steady_end = course.node(cell + 1).1;
            let most_phases = phases.len() + MOST_SWITCHES_PER_CELL;
            loop {
                let friction = sliding_friction(&self.friction, state.motion);
                let switch = match friction {
                    None => self.breakaway(cell, anchor.time_s),
                    Some(friction) => {
                        let whole_cell = anchor.time_s <= course.time(cell);
                        let kept = if whole_cell {
                            course.kept(cell)
                        } else {
                            (-self.a * (cell_end - anchor.time_s)).exp()
                        };
                        let offset = friction / self.a;
                        let x_end =
                            steady_end - offset + (anchor.x - anchor.steady + offset) * kept;
                        let stop = self.stop(cell, anchor, friction, state.motion, x_end);
                        if stop.is_none() {
                            anchor = Anchor { time_s: cell_end, x: x_end, steady: steady_end };
                        }
                        stop
                    }
                };
                let Some((time_s, motion)) = switch else { break };
                if phases.len() == most_phases {
                    return None;
                }
                let (torque, steady) = course.both(cell, time_s);
                // Derivative of this instant by the one before, or by the initial x.
                slope *= match (friction, last) {
                    (None, _) => 0.0,
                    (Some(friction), None) => -(-self.a * time_s).exp() / (torque - friction),
                    (Some(friction), Some((before_s, before))) => {
                        (-self.a * (time_s - before_s)).exp() * (before - friction)
                            / (torque - friction)
                    }
                };
                phases.push(Phase { start_s: time_s, motion });
                last = Some((time_s, torque));
                state.motion = motion;
                anchor = Anchor { time_s, x: 0.0, steady };
            }
            if state.motion == Motion::Stuck {
                anchor = Anchor { time_s: cell_end, x: 0.0, steady: steady_end };
            }
        }
        let end_s = course.time(course.cells());
        slope *= match (last, sliding_friction(&self.friction, state.motion)) {
            (_, None) => 0.0,
            (None, Some(_)) => (-self.a * end_s).exp(),
            (Some((last_s, torque)), Some(friction)) => {
                -(-self.a * (end_s - last_s)).exp() * (torque - friction)
            }
        };
        Some(Pass { phases, end: State { x: anchor.x, motion: state.motion }, slope })
    }

    /// The instant within the cell at which the torque exceeds a static level.
    fn breakaway(&self, cell: usize, from_s: f64) -> Option<(f64, Motion)> {
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
        let mut low = from_s;
        let mut high = course.time(cell + 1);
        let length_s = high - low;
        let motion = match direction(course.node(cell + 1).0) {
            Some(motion) => motion,
            None => {
                high = self.top(cell, from_s)?;
                direction(course.torque(cell, high).0)?
            }
        };
        let level = if motion == Motion::Forward { plus } else { -minus };
        let mut time_s = 0.5 * (low + high);
        for _ in 0..60 {
            let (torque, rate) = course.torque(cell, time_s);
            let excess = torque - level;
            if (excess > 0.0) == (motion == Motion::Forward) {
                high = time_s;
            } else {
                low = time_s;
            }
            let newton = time_s - excess / rate;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let moved = (next - time_s).abs();
            time_s = next;
            if moved <= LAST_STEP * length_s {
                break;
            }
        }
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
    fn stop(
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
        let mut time_s;
        if crosses && fresh && rate_start > 0.0 {
            // It leaves zero and returns to it within the cell: look beyond the top.
            low = bisect(low, high, |t| x(t).1 > 0.0);
            time_s = 0.5 * (low + high);
        } else if crosses {
            // Begin where the cubic through values and slopes of both ends meets zero.
            let (y, d) = (sign * anchor.x, rate_start * length_s);
            let value = sign * x_end - y - d;
            let slope = rate_end * length_s - d;
            let (square, cube) = (3.0 * value - slope, slope - 2.0 * value);
            let fallen = |u: f64| -(((cube * u + square) * u + d) * u + y);
            let falls = |u: f64| -((3.0 * cube * u + 2.0 * square) * u + d);
            time_s = low + length_s * root(0.0, 1.0, fallen, falls);
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
            time_s = 0.5 * (low + high);
        }
        for _ in 0..60 {
            let (value, rate) = x(time_s);
            if value > 0.0 {
                low = time_s;
            } else {
                high = time_s;
            }
            let newton = time_s - value / rate;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let moved = (next - time_s).abs();
            time_s = next;
            if moved <= LAST_STEP * length_s {
                break;
            }
        }
        let torque = course.torque(cell, time_s).0;
        let next = match motion {
            Motion::Forward if torque < -self.friction.fs_minus => Motion::Backward,
            Motion::Backward if torque > self.friction.fs_plus => Motion::Forward,
            _ => Motion::Stuck,
        };
        Some((time_s, next))
    }
}
