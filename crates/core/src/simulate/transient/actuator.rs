//! The actuator's transient response, as a piecewise quintic.
//!
//! The input is piecewise linear, and every kink excites the actuator's modes. The cells of the
//! response are short while a mode decays, and as long as the input's piece after that.

use crate::plant::Actuator;

use super::command::Line;
use super::motion::InitialState;
use crate::simulate::piecewise_linear::drive::{Mode, modes};
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic, through};

/// Largest angle (or number of time constants) of a mode in one cell. The quintic then misses 7e-5
/// of the response to a kink.
const CELL_ANGLE: f64 = 1.2;

/// Ratio of successive cell boundaries behind a kink, as times since the kink, while a real mode
/// decays. Tuned.
const GROWTH: f64 = 1.5;

/// Time constants after which a mode has decayed: exp(−14) = 8e-7.
const LAYER_END: f64 = 14.0;

/// The torque over all `lines`. Before them the actuator's input was `input_before`.
pub(super) fn torque(
    actuator: &Actuator,
    lines: &[Line],
    input_before: f64,
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
    let mut states = start(&modes, input_before, initial);
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

/// A straight line as a quintic.
fn straight(start: f64, change: f64) -> [f64; 6] {
    [start, change, 0.0, 0.0, 0.0, 0.0]
}

/// Initial states of the modes: at rest under `input_before`, unless `initial` gives other values.
fn start(modes: &[Mode<f64>], input_before: f64, initial: &InitialState) -> Vec<ComplexDual<f64>> {
    let torque = initial.torque.unwrap_or(input_before);
    let rate = initial.torque_rate.unwrap_or(0.0);
    match modes {
        [Mode { rate: l, residue, count: 2.0 }] => {
            // τ = 2 Re z and τ' = 2 Re λz, where z is the state times the residue.
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

/// τ, τ' and τ'' under the input u, which changes at the rate `slope`.
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

/// Division of an input piece of one length into cells.
struct Division {
    length_s: f64,
    parts: Vec<Part>,
    /// Whether all parts have the same length.
    even: bool,
}

/// A cell; `from` is its start within the piece, `steps` has an integrator for each mode.
struct Part {
    from: f64,
    length_s: f64,
    steps: Vec<ExponentialIntegrator<ComplexDual<f64>>>,
}

impl Division {
    fn new(modes: &[Mode<f64>], length_s: f64) -> Self {
        // |λ| and decay rate of every mode.
        let rates = modes.iter().map(|m| (m.rate.value().norm(), -m.rate.re));
        let allowed = |since: f64| {
            let allow = |(size, decay): (f64, f64)| match decay * since {
                over if over > LAYER_END => f64::INFINITY,
                // A real mode: the cells may grow as it decays.
                _ if decay >= 0.999 * size => CELL_ANGLE.max((GROWTH - 1.0) * size * since) / size,
                _ => CELL_ANGLE / size,
            };
            rates.clone().map(allow).fold(f64::INFINITY, f64::min)
        };
        let count = (length_s / allowed(0.0)).ceil();
        // Up to four equal parts are better than parts of growing length.
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
