//! The actuator's transient response, as a piecewise quintic.
//!
//! The input is straight piece by piece, and every kink excites the actuator's own modes. Pieces of
//! the response are short where a mode still decays and as long as the input's piece after that.

use crate::plant::Actuator;

use super::command::Line;
use super::motion::InitialState;
use crate::simulate::piecewise_linear::drive::{Mode, modes};
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic, through};

/// Radians, or time constants, of the actuator in one cell: its quintic misses by 7e-5 of
/// what a kink sets off.
const REACH: f64 = 1.2;

/// Growth of the cells behind a kink, while what it set off dies out.
const GROWTH: f64 = 1.5;

/// Time constants after which nothing of it is left.
const OVER: f64 = 14.0;

/// The torque over all `lines`; before them the actuator was told `told`.
pub(super) fn torque(
    actuator: &Actuator,
    lines: &[Line],
    told: f64,
    initial: &InitialState,
) -> PiecewiseQuintic<f64> {
    let period_s = lines.last().map_or(0.0, |line| line.from_s + line.length_s);
    let modes = modes(actuator);
    if modes.is_empty() {
        let cells = lines.iter().enumerate().map(|(n, line)| Cell {
            from_s: line.from_s,
            length_s: line.length_s,
            powers: straight(line.start, line.slope * line.length_s),
            whole: Some(n),
        });
        return PiecewiseQuintic { cells: cells.collect(), period_s };
    }
    let mut states = start(&modes, told, initial);
    let mut cells = Vec::with_capacity(lines.len());
    let mut division = Division::new(&modes, 0.0);
    for line in lines {
        if division.length_s != line.length_s {
            division = Division::new(&modes, line.length_s);
        }
        for (index, Part { from, length_s, steps }) in division.parts.iter().enumerate() {
            let (u, slope) = (line.start + line.slope * from, line.slope);
            let powers = straight(u, slope * length_s);
            let left = node(&modes, &states, u, slope);
            for (state, step) in states.iter_mut().zip(steps) {
                *state = step.step(*state, &powers, *length_s);
            }
            let right = node(&modes, &states, u + slope * length_s, slope);
            let scaled = |[value, first, second]: [f64; 3]| {
                [value, first * length_s, second * length_s * length_s]
            };
            cells.push(Cell {
                from_s: line.from_s + from,
                length_s: *length_s,
                powers: through(scaled(left), scaled(right)),
                whole: division.even.then_some(index),
            });
        }
    }
    PiecewiseQuintic { cells, period_s }
}

fn straight(start: f64, change: f64) -> [f64; 6] {
    [start, change, 0.0, 0.0, 0.0, 0.0]
}

/// States of the modes: at rest under what the actuator was told, where nothing else is given.
fn start(modes: &[Mode<f64>], told: f64, initial: &InitialState) -> Vec<ComplexDual<f64>> {
    let torque = initial.torque.unwrap_or(told);
    let rate = initial.torque_rate.unwrap_or(0.0);
    match modes {
        [Mode { rate: l, residue, count: 2.0 }] => {
            // τ = 2 Re z and τ' = 2 Re λz, where z is the residue's share of the state.
            let re = 0.5 * torque;
            let z = ComplexDual::new(re, (l.re * re - 0.5 * rate) / l.im);
            vec![z * residue.inverse()]
        }
        [one, other] => {
            let (a, b) = (one.rate.re, other.rate.re);
            let z = (rate - b * torque) / (a - b);
            let state = |z: f64, mode: &Mode<f64>| ComplexDual::real(z / mode.residue.re);
            vec![state(z, one), state(torque - z, other)]
        }
        _ => modes.iter().map(|mode| ComplexDual::real(torque / mode.residue.re)).collect(),
    }
}

/// τ, τ' and τ'' where the actuator is told u, which changes at this rate.
fn node(modes: &[Mode<f64>], states: &[ComplexDual<f64>], u: f64, slope: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (mode, state) in modes.iter().zip(states) {
        let first = *state * mode.rate + ComplexDual::real(u);
        let second = first * mode.rate + ComplexDual::real(slope);
        for (sum, part) in sums.iter_mut().zip([*state, first, second]) {
            *sum += (part * mode.residue).re * mode.count;
        }
    }
    sums
}

/// How a piece of some length is divided into cells.
struct Division {
    length_s: f64,
    parts: Vec<Part>,
    /// Whether all parts are of one length.
    even: bool,
}

struct Part {
    from: f64,
    length_s: f64,
    steps: Vec<ExponentialIntegrator<ComplexDual<f64>>>,
}

impl Division {
    fn new(modes: &[Mode<f64>], length_s: f64) -> Self {
        // Of every mode how fast it turns, and how fast it dies out.
        let rates = modes.iter().map(|m| (m.rate.value().norm(), -m.rate.re));
        let allowed = |since: f64| {
            let allow = |(size, decay): (f64, f64)| match decay * since {
                over if over > OVER => f64::INFINITY,
                // A mode that does not turn fades as well as it can.
                _ if decay >= 0.999 * size => REACH.max((GROWTH - 1.0) * size * since) / size,
                _ => REACH / size,
            };
            rates.clone().map(allow).fold(f64::INFINITY, f64::min)
        };
        let count = (length_s / allowed(0.0)).ceil();
        // Two even halves serve better than a layer.
        let even = count <= 4.0;
        let mut bounds = vec![0.0];
        while let Some(from) = bounds.last().copied().filter(|from| *from < length_s) {
            let longest_s = if even { length_s / count } else { allowed(from) };
            let ends = from + 1.2 * longest_s >= length_s;
            bounds.push(if ends { length_s } else { from + longest_s });
        }
        let part = |pair: &[f64]| {
            let length_s = if even { length_s / count } else { pair[1] - pair[0] };
            let step = |mode: &Mode<f64>| {
                let turns = ComplexDual::new(-mode.rate.re, -mode.rate.im).scaled(length_s);
                ExponentialIntegrator::complex(turns)
            };
            Part { from: pair[0], length_s, steps: modes.iter().map(step).collect() }
        };
        Self { length_s, parts: bounds.windows(2).map(part).collect(), even }
    }
}
