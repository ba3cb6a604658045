//! The base model's motion under any periodic torque.
//!
//! The torque τ, and the steady response w of the lag 1/(s + a) to it, are sampled on a uniform
//! grid. While the axis slides with friction σ, x = w − σ/a + C·exp(−a·t). A pass over one period
//! looks in every cell of the grid for a change of sign of x while sliding, or of the torque's
//! excess over the static level while at rest; a bracketed Newton's method finds the time. Periods
//! are integrated from rest until the state repeats. Newton's method on the return map (Poincaré
//! map), whose slope the pass gives, accelerates this.

mod event_location;
mod sampled_torque;

use crate::measurement::Complex;
use crate::plant::{Friction, Plant};

use super::spectrum::sliding_friction;
use super::switching_times::{Motion, Phase, SwitchingTimes};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::samples::Samples;
use sampled_torque::SampledTorque;

/// Most periods integrated from rest; beyond that the motion counts as not periodic.
const MOST_PERIODS: usize = 400;

/// Rounding error of x as a share of the largest |w|: the tolerance for a periodic motion, and for
/// the sign of x just after a switch.
const RELATIVE_ROUNDING: f64 = 1e-13;

/// Most switches in one cell; more mean that the switching times accumulate.
const MOST_SWITCHES_PER_CELL: usize = 64;

/// The periodic motion reached from rest under a general input, and the sampled torque. `lines` are
/// the torque lines Tₗ = A(jlω)·Uₗ.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(crate) fn orbit(
    plant: &Plant,
    lines: &[Complex],
    excitation: &Excitation,
    grid: &Grid,
) -> Result<(SwitchingTimes, Samples), NoResponse> {
    let waves = SampledTorque::new(plant, lines, excitation, grid);
    let orbit = follow(plant, &waves, excitation.period_s())?;
    Ok((orbit, waves.torque))
}

/// The periodic motion reached from rest under a sampled torque.
fn follow(
    plant: &Plant,
    sampled: &SampledTorque,
    period_s: f64,
) -> Result<SwitchingTimes, NoResponse> {
    let scale = (0..sampled.cells()).fold(0.0, |most: f64, n| most.max(sampled.node(n).1.abs()));
    let friction = plant.friction;
    let motion = AxisOnGrid { a: plant.viscous_rate_rad_s, friction, sampled, scale };
    let unique = friction.fs_plus == friction.fc_plus && friction.fs_minus == friction.fc_minus;
    let mut start = State { x: 0.0, motion: Motion::Stuck };
    for period in 0..MOST_PERIODS {
        let pass = motion.pass(start).ok_or(NoResponse::NotPeriodic { periods: period })?;
        let change = pass.end.x - start.x;
        // The first pass starts from rest, which need not be part of the periodic motion.
        if period > 0
            && pass.end.motion == start.motion
            && change.abs() <= RELATIVE_ROUNDING * scale
        {
            return Ok(pass.into_orbit(period_s));
        }
        // A Newton step is taken only if it cannot lead to another periodic motion.
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

/// State of the axis: x = v/K, and whether it slides or rests.
#[derive(Clone, Copy)]
struct State {
    x: f64,
    motion: Motion,
}

/// Result of one pass over a period.
struct Pass {
    phases: Vec<Phase>,
    end: State,
    /// Slope of the return map: derivative of the final x by the initial x.
    slope: f64,
}

impl Pass {
    fn into_orbit(self, period_s: f64) -> SwitchingTimes {
        if self.phases.is_empty() {
            SwitchingTimes::constant(period_s, self.end.motion)
        } else {
            SwitchingTimes { period_s, phases: self.phases }
        }
    }
}

/// The mechanics of an axis under a sampled torque.
struct AxisOnGrid<'a> {
    a: f64,
    friction: Friction,
    sampled: &'a SampledTorque,
    /// Largest |w|.
    scale: f64,
}

/// A point of the motion, from which x is continued; `steady` is w there.
#[derive(Clone, Copy)]
struct Anchor {
    time_s: f64,
    x: f64,
    steady: f64,
}

impl AxisOnGrid<'_> {
    /// Follows the motion over one period; `None` where the switching times accumulate.
    fn pass(&self, start: State) -> Option<Pass> {
        let sampled = self.sampled;
        let mut phases = Vec::new();
        let mut slope = 1.0;
        let mut state = start;
        let mut anchor = Anchor { time_s: 0.0, x: start.x, steady: sampled.node(0).1 };
        // Time and torque of the last switch.
        let mut last: Option<(f64, f64)> = None;
        for cell in 0..sampled.cells() {
            let cell_end = sampled.time(cell + 1);
            let steady_end = sampled.node(cell + 1).1;
            let most_phases = phases.len() + MOST_SWITCHES_PER_CELL;
            loop {
                let friction = sliding_friction(&self.friction, state.motion);
                let switch = match friction {
                    None => self.breakaway(cell, anchor.time_s),
                    Some(friction) => {
                        let whole_cell = anchor.time_s <= sampled.time(cell);
                        let kept = if whole_cell {
                            sampled.kept
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
                let (torque, steady) = sampled.both(cell, time_s);
                // Derivative of this time by that of the switch before, or by the initial x.
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
        let end_s = sampled.time(sampled.cells());
        slope *= match (last, sliding_friction(&self.friction, state.motion)) {
            (_, None) => 0.0,
            (None, Some(_)) => (-self.a * end_s).exp(),
            (Some((last_s, torque)), Some(friction)) => {
                -(-self.a * (end_s - last_s)).exp() * (torque - friction)
            }
        };
        Some(Pass { phases, end: State { x: anchor.x, motion: state.motion }, slope })
    }
}
