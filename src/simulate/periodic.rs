//! Motion under any periodic torque.
//!
//! Torque τ and the steady response w of 1/(s + a) to it are computed on a
//! uniform grid by FFT (`samples`). While the axis slides, x = w − σ/a + C·exp(−a·t): the
//! free part shrinks by the same factor every sample, so one pass over the grid
//! finds the cells in which the motion switches, and a bracketed Newton's
//! method on the interpolated w finds the instant. The pass is linear in
//! samples and in switches. Periods follow one another from rest; the state at
//! their start converges by Newton's method on the return map, whose slope the
//! pass gives along the way.

use crate::measurement::Complex;
use crate::plant::{Friction, Plant};

use super::NoResponse;
use super::excitation::{Excitation, Grid};
use super::orbit::{Motion, Orbit, Phase};
use super::samples::{Samples, quintic_at};
use super::spectrum::sliding_friction;

/// Periods after which a motion from rest counts as not periodic.
const MOST_PERIODS: usize = 400;

/// Share of the largest x that is lost in rounding.
const ROUNDING: f64 = 1e-13;

/// Switches of one cell beyond which time has stopped passing.
const MOST_SWITCHES_PER_CELL: usize = 64;

/// The motion reached from rest, and the torque it was found with; `lines` are
/// the torque lines.
pub(super) fn orbit(
    plant: &Plant,
    lines: &[Complex],
    excitation: &Excitation,
    grid: &Grid,
) -> Result<(Orbit, Samples), NoResponse> {
    let waves = Waves::new(plant, lines, excitation, grid);
    let unique = plant.friction.fs_plus == plant.friction.fc_plus
        && plant.friction.fs_minus == plant.friction.fc_minus;
    let mut start = State { x: 0.0, motion: Motion::Stuck };
    for period in 0..MOST_PERIODS {
        let pass = waves.pass(start).ok_or(NoResponse::NotPeriodic { periods: period })?;
        let change = pass.end.x - start.x;
        // `start` of the first pass is a guess (rest), never part of the motion.
        if period > 0 && pass.end.motion == start.motion && change.abs() <= ROUNDING * waves.scale {
            return Ok((pass.into_orbit(excitation.period_s()), waves.torque));
        }
        // Newton's step may only jump where every start leads to the same motion.
        let jump = unique || change.abs() < 1e-3 * waves.scale;
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
    friction: Friction,
    torque: Samples,
    /// w: steady response of 1/(s + a) to the torque.
    steady: Vec<f64>,
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
        let scale = steady.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
        Self { a, friction: plant.friction, torque, steady, scale }
    }

    /// Follows the motion over one period; `None` where it switches without end.
    fn pass(&self, start: State) -> Option<Pass> {
        let mut phases = Vec::new();
        let mut slope = 1.0;
        let mut state = start;
        let mut anchor = Anchor { time_s: 0.0, x: start.x, steady: self.steady[0] };
        let step_kept = (-self.a * self.torque.step_s).exp();
        for cell in 0..self.torque.cells() {
            let cell_end = (cell + 1) as f64 * self.torque.step_s;
            let most_phases = phases.len() + MOST_SWITCHES_PER_CELL;
            loop {
                let switch = match sliding_friction(&self.friction, state.motion) {
                    None => self.breakaway(cell, anchor.time_s),
                    Some(friction) => {
                        let whole_cell = anchor.time_s <= cell as f64 * self.torque.step_s;
                        let kept = if whole_cell {
                            step_kept
                        } else {
                            (-self.a * (cell_end - anchor.time_s)).exp()
                        };
                        let offset = friction / self.a;
                        let x_end = self.steady[cell + 1] - offset
                            + (anchor.x - anchor.steady + offset) * kept;
                        let stop = self.stop(cell, anchor, friction, state.motion, x_end);
                        if stop.is_none() {
                            anchor = Anchor {
                                time_s: cell_end,
                                x: x_end,
                                steady: self.steady[cell + 1],
                            };
                        }
                        stop
                    }
                };
                let Some((time_s, motion)) = switch else { break };
                if phases.len() == most_phases {
                    return None;
                }
                slope *= self.slope_through(start, &phases, state.motion, time_s, cell);
                phases.push(Phase { start_s: time_s, motion });
                state.motion = motion;
                anchor = Anchor { time_s, x: 0.0, steady: self.steady_at(cell, time_s) };
            }
            if state.motion == Motion::Stuck {
                anchor = Anchor { time_s: cell_end, x: 0.0, steady: self.steady[cell + 1] };
            }
        }
        let end_s = self.torque.cells() as f64 * self.torque.step_s;
        slope *= match (phases.last(), sliding_friction(&self.friction, state.motion)) {
            (_, None) => 0.0,
            (None, Some(_)) => (-self.a * end_s).exp(),
            (Some(last), Some(friction)) => {
                let cell = self.torque.cell_of(last.start_s);
                -(-self.a * (end_s - last.start_s)).exp()
                    * (self.torque.at(cell, last.start_s) - friction)
            }
        };
        Some(Pass { phases, end: State { x: anchor.x, motion: state.motion }, slope })
    }

    /// Derivative of this switch's instant by the previous one's (by the
    /// initial x, if it is the first).
    fn slope_through(
        &self,
        start: State,
        phases: &[Phase],
        motion: Motion,
        time_s: f64,
        cell: usize,
    ) -> f64 {
        let Some(friction) = sliding_friction(&self.friction, motion) else { return 0.0 };
        let rate = self.torque.at(cell, time_s) - friction;
        match phases.last() {
            None if start.motion == Motion::Stuck => 0.0,
            None => -(-self.a * time_s).exp() / rate,
            Some(last) => {
                let before =
                    self.torque.at(self.torque.cell_of(last.start_s), last.start_s) - friction;
                (-self.a * (time_s - last.start_s)).exp() * before / rate
            }
        }
    }

    /// The instant within the cell at which the torque exceeds a static level.
    fn breakaway(&self, cell: usize, from_s: f64) -> Option<(f64, Motion)> {
        let (plus, minus) = (self.friction.fs_plus, self.friction.fs_minus);
        let direction = |torque: f64| match torque {
            t if t > plus => Some(Motion::Forward),
            t if t < -minus => Some(Motion::Backward),
            _ => None,
        };
        if let Some(motion) = direction(self.torque.at(cell, from_s)) {
            return Some((from_s, motion));
        }
        let mut low = from_s;
        let mut high = (cell + 1) as f64 * self.torque.step_s;
        let motion = match direction(self.torque.value[cell + 1]) {
            Some(motion) => motion,
            None => {
                high = self.top(cell, from_s)?;
                direction(self.torque.at(cell, high))?
            }
        };
        let level = if motion == Motion::Forward { plus } else { -minus };
        let mut time_s = 0.5 * (low + high);
        for _ in 0..60 {
            let excess = self.torque.at(cell, time_s) - level;
            if (excess > 0.0) == (motion == Motion::Forward) {
                high = time_s;
            } else {
                low = time_s;
            }
            let newton = time_s - excess / self.torque.slope_at(cell, time_s);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - time_s).abs();
            time_s = next;
            if moved <= 1e-13 * self.torque.step_s + 2.0 * f64::EPSILON * time_s {
                break;
            }
        }
        Some((time_s, motion))
    }

    /// The instant within the cell at which the torque turns back, where its
    /// tangent at the end lets it exceed a static level between two samples.
    fn top(&self, cell: usize, from_s: f64) -> Option<f64> {
        let end_s = (cell + 1) as f64 * self.torque.step_s;
        let rate_end = self.torque.first[cell + 1];
        let sign = -rate_end.signum();
        let level = if sign > 0.0 { self.friction.fs_plus } else { self.friction.fs_minus };
        let reach = sign * self.torque.value[cell + 1] + rate_end.abs() * (end_s - from_s);
        if reach <= level {
            return None;
        }
        let rises = |time_s: f64| sign * self.torque.slope_at(cell, time_s) > 0.0;
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
        let sign = if motion == Motion::Forward { 1.0 } else { -1.0 };
        let cell_end = (cell + 1) as f64 * self.torque.step_s;
        let rate_start =
            sign * (-self.a * anchor.x + self.torque.at(cell, anchor.time_s) - friction);
        let rate_end = sign * (-self.a * x_end + self.torque.value[cell + 1] - friction);
        let x = |time_s: f64| {
            let kept = (-self.a * (time_s - anchor.time_s)).exp();
            let offset = friction / self.a;
            sign * (self.steady_at(cell, time_s) - offset
                + (anchor.x - anchor.steady + offset) * kept)
        };
        let rate =
            |time_s: f64, x: f64| -self.a * x + sign * (self.torque.at(cell, time_s) - friction);
        // A slide that began within the cell leaves zero, whatever rounding makes of
        // its first instants: a stop there would be a breakaway again, for ever.
        let fresh = anchor.x == 0.0;
        let crosses = sign * x_end < if fresh { -ROUNDING * self.scale } else { 0.0 };
        let (mut low, mut high) = (anchor.time_s, cell_end);
        if crosses && fresh && rate_start > 0.0 {
            // It leaves zero and returns to it within the cell: look beyond the top.
            low = bisect(low, high, |t| rate(t, x(t)) > 0.0);
        } else if !crosses {
            // It may dip below zero between two samples, if its tangent does.
            let within_reach = sign * anchor.x + rate_start * (cell_end - anchor.time_s) < 0.0;
            if fresh || !(rate_start < 0.0 && rate_end > 0.0 && within_reach) {
                return None;
            }
            high = bisect(low, high, |t| rate(t, x(t)) < 0.0);
            if x(high) >= 0.0 {
                return None;
            }
        }
        let mut time_s = 0.5 * (low + high);
        for _ in 0..60 {
            let value = x(time_s);
            if value > 0.0 {
                low = time_s;
            } else {
                high = time_s;
            }
            let newton = time_s - value / rate(time_s, value);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - time_s).abs();
            time_s = next;
            if moved <= 1e-13 * self.torque.step_s + 2.0 * f64::EPSILON * time_s {
                break;
            }
        }
        let torque = self.torque.at(cell, time_s);
        let next = match motion {
            Motion::Forward if torque < -self.friction.fs_minus => Motion::Backward,
            Motion::Backward if torque > self.friction.fs_plus => Motion::Forward,
            _ => Motion::Stuck,
        };
        Some((time_s, next))
    }

    /// w between samples, by the quintic through values and two derivatives,
    /// which w' = −a·w + τ gives exactly.
    fn steady_at(&self, cell: usize, time_s: f64) -> f64 {
        let h = self.torque.step_s;
        let end = |n: usize| {
            let first = self.torque.value[n] - self.a * self.steady[n];
            let second = self.torque.first[n] - self.a * first;
            [self.steady[n], h * first, h * h * second]
        };
        quintic_at(end(cell), end(cell + 1), time_s / h - cell as f64)
    }
}

/// The end of the stretch from `low` on which `holds`; it fails at `high`.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
