//! From the input to the torque behind the actuator, when the input is bent on
//! the way.
//!
//! The input is a wave of quintics. Static maps cut its cells where their slope
//! changes and act on each part exactly; the rate limiter replaces parts by
//! ramps; the actuator's modes answer each part exactly, from their own
//! periodic state. Every signal on the way is continuous, so a cut that moves
//! with a parameter changes nothing to first order.

use crate::effects::{Axis, InputMap};
use crate::measurement::Complex;
use crate::plant::{Actuator, Dual, Scalar};

use super::excitation::{Excitation, Grid};
use super::pair::Pair;
use super::rate_limit;
use super::relaxation::Relaxation;
use super::sensitivity::actuator_derivatives;
use super::wave::{Cell, Wave, through};

/// Radians of an oscillation in one cell: its quintic misses by 7e-5 of what
/// rings after a kink, itself a hundredth of the torque at most.
const RADIANS_PER_CELL: f64 = 1.2;

/// Natural frequency, in the highest frequency of the input, above which an actuator that
/// rings is a delay: of the torque it changes a millionth, and of the velocity less.
const FAST: f64 = 1000.0;

/// Growth of the cells behind a kink, while what it excited dies out.
const LAYER_GROWTH: f64 = 1.5;

/// Time constants after which nothing of it is left.
const LAYER_END: f64 = 14.0;

/// The torque on the mechanics, and the grid of its cells: at least `fewest` of
/// them for a period of a cosine.
pub(super) fn torque<'e, S: Scalar>(
    axis: &Axis<S>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (Wave<S>, &'e Grid) {
    let omega = excitation.omega_rad_s();
    let actuator = &axis.plant.actuator;
    if axis.has_linear_input() {
        let grid = excitation.grid().unwrap_or_else(|| Grid::at_least(fewest));
        return (linear(actuator, excitation, grid), grid);
    }
    // Well damped, it dies out in the layers behind a kink.
    let ringing = match actuator.map(Scalar::value) {
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } if damping_ratio < 2.0 => {
            natural_frequency_rad_s
        }
        _ => 0.0,
    };
    // A delay does not mind whether it comes before or after what bends the input.
    let highest = omega * (excitation.input().len() - 1) as f64;
    let delays = ringing > FAST * highest;
    let ringing = if delays { 0.0 } else { ringing };
    let [ahead, behind] = match delays {
        true => [actuator, &Actuator::Direct],
        false => [&Actuator::Direct, actuator],
    };
    let cells = (std::f64::consts::TAU * ringing / omega / RADIANS_PER_CELL) as usize;
    let own = excitation.grid().filter(|grid| grid.samples() >= cells);
    let grid = own.unwrap_or_else(|| {
        Grid::at_least(cells.max(excitation.grid().map_or(fewest, Grid::samples)))
    });
    let mut wave = linear(ahead, excitation, grid);
    for map in &axis.input_maps {
        wave = mapped(&wave, map);
    }
    if let Some(rate) = axis.rate_limit {
        wave = rate_limit::limited(&wave, rate);
    }
    (delivered(behind, wave), grid)
}

/// The same for an axis of many variables: the torque depends on those few that
/// stand ahead of the mechanics, and is computed with them alone.
pub(super) fn torque_of_few<'e, const N: usize>(
    axis: &Axis<Dual<N>>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (Wave<Dual<N>>, &'e Grid) {
    let mut ahead: Vec<Dual<N>> = axis.rate_limit.into_iter().collect();
    let _ = axis.plant.actuator.map(|value| ahead.push(value));
    for map in &axis.input_maps {
        ahead.extend(map.breaks.iter().chain(&map.slopes));
    }
    let used: Vec<usize> =
        (0..N).filter(|lane| ahead.iter().any(|value| value.lane(*lane) != 0.0)).collect();
    if used.len() > FEW {
        return torque(axis, excitation, fewest);
    }
    let few = axis.map(|x| {
        Dual::<FEW>::with_lanes(x.value(), |lane| used.get(lane).map_or(0.0, |l| x.lane(*l)))
    });
    let (wave, grid) = torque(&few, excitation, fewest);
    let mut place = [FEW; N];
    used.iter().enumerate().for_each(|(i, lane)| place[*lane] = i);
    (wave.map(|x| Dual::with_lanes(x.value(), |lane| x.lane(place[lane]))), grid)
}

/// Variables of a torque that are few.
const FEW: usize = 4;

/// A(s)·u where nothing bends u.
fn linear<S: Scalar>(actuator: &Actuator<S>, excitation: &Excitation, grid: &Grid) -> Wave<S> {
    let omega = excitation.omega_rad_s();
    if excitation.is_pure_cosine() {
        let line = response(actuator, omega) * excitation.input()[1];
        return Wave::cosine(grid, omega, line);
    }
    let numbers = actuator.map(Scalar::value);
    let lines = excitation.torque_lines(&numbers);
    let coefficients = match *actuator {
        Actuator::Direct => vec![],
        Actuator::FirstOrder { corner_rad_s } => vec![corner_rad_s],
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            vec![natural_frequency_rad_s, damping_ratio]
        }
    };
    let varies = |by: &S| (0..S::LANES).any(|lane| by.lane(lane) != 0.0);
    let derivatives: Vec<(S, Vec<Complex>)> = coefficients
        .into_iter()
        .zip(actuator_derivatives(&numbers, excitation))
        .filter(|(by, _)| varies(by))
        .collect();
    Wave::of_lines(grid, omega, &lines, &derivatives)
}

/// A(jω).
pub(super) fn response<S: Scalar>(actuator: &Actuator<S>, omega: f64) -> Pair<S> {
    let one = S::constant(1.0);
    match *actuator {
        Actuator::Direct => Pair::real(one),
        Actuator::FirstOrder { corner_rad_s: p } => {
            Pair::new(p, S::constant(omega)).inverse().scaled(p)
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            let square = wn * wn;
            let denominator = Pair::new(square - omega * omega, zeta * wn * (2.0 * omega));
            denominator.inverse().scaled(square)
        }
    }
}

/// The wave behind a static map.
fn mapped<S: Scalar>(wave: &Wave<S>, map: &InputMap<S>) -> Wave<S> {
    let mut cells = Vec::with_capacity(wave.cells.len() + 8);
    let breaks: Vec<f64> = map.breaks.iter().map(|at| at.value()).collect();
    let pieces: Vec<(S, S)> = (0..map.slopes.len()).map(|i| map.piece(i)).collect();
    for cell in &wave.cells {
        let mut cuts = vec![0.0, 1.0];
        for level in &breaks {
            cuts.extend(crossings(cell, *level));
        }
        cuts.sort_by(f64::total_cmp);
        for cut in cuts.windows(2).filter(|cut| cut[1] - cut[0] > 1e-12) {
            let mut part = cell.part(cut[0], cut[1]);
            let middle = part.number(0.5);
            let (offset, slope) = pieces[breaks.iter().filter(|at| **at < middle).count()];
            for power in &mut part.powers {
                *power = *power * slope;
            }
            part.powers[0] += offset;
            cells.push(part);
        }
    }
    Wave { cells, period_s: wave.period_s }
}

/// Where a cell passes a level, in either direction.
fn crossings<S: Scalar>(cell: &Cell<S>, level: f64) -> Vec<f64> {
    let start = cell.number(0.0) - level;
    let sign = if start > 0.0 { -1.0 } else { 1.0 };
    let Some(first) = cell.crossing(0.0, level, sign) else { return vec![] };
    // Where it turned back between both ends it crosses twice.
    let returns = sign * (cell.number(1.0) - level) < 0.0;
    let second = if returns { cell.crossing(first, level, -sign) } else { None };
    std::iter::once(first).chain(second).collect()
}

/// A first-order mode η' = λη + u of the actuator, and what it adds to τ.
#[derive(Clone, Copy)]
pub(super) struct Mode<S> {
    pub rate: Pair<S>,
    pub residue: Pair<S>,
    /// 2 where its conjugate adds the same.
    pub count: f64,
}

pub(super) fn modes<S: Scalar>(actuator: &Actuator<S>) -> Vec<Mode<S>> {
    match *actuator {
        Actuator::Direct => vec![],
        Actuator::FirstOrder { corner_rad_s: p } => {
            vec![Mode { rate: Pair::real(-p), residue: Pair::real(p), count: 1.0 }]
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            // A = ωₙ²/((s − λ₁)(s − λ₂)); where both are the same, next to it.
            let mut inside = zeta * zeta - 1.0;
            if inside.value().abs() < 1e-8 {
                inside = inside + 2e-8;
            }
            let real = -(zeta * wn);
            let zero = S::constant(0.0);
            if inside.value() < 0.0 {
                let turning = wn * (-inside).sqrt();
                let residue = Pair::new(zero, -(wn * wn / (turning * 2.0)));
                vec![Mode { rate: Pair::new(real, turning), residue, count: 2.0 }]
            } else {
                let apart = wn * inside.sqrt();
                let residue = wn * wn / (apart * 2.0);
                vec![
                    Mode {
                        rate: Pair::real(real + apart),
                        residue: Pair::real(residue),
                        count: 1.0,
                    },
                    Mode {
                        rate: Pair::real(real - apart),
                        residue: Pair::real(-residue),
                        count: 1.0,
                    },
                ]
            }
        }
    }
}

/// The wave behind the actuator, in its periodic state.
fn delivered<S: Scalar>(actuator: &Actuator<S>, wave: Wave<S>) -> Wave<S> {
    let modes = modes(actuator);
    if modes.is_empty() {
        return wave;
    }
    let wave = layered(wave, &modes);
    let zero = S::constant(0.0);
    // τ, τ' and τ'' at both ends of every cell.
    let mut ends = vec![([zero; 3], [zero; 3]); wave.cells.len()];
    for mode in &modes {
        let steps = Steps::new(mode, &wave);
        let travelled = wave
            .cells
            .iter()
            .zip(steps.over(&wave))
            .fold(Pair::real(zero), |state, (cell, step)| {
                step.step(state, &cell.powers, cell.length_s)
            });
        let kept = mode.rate.scaled(S::constant(wave.period_s)).exp();
        let left = Pair::new(-kept.re + 1.0, -kept.im);
        let mut state = travelled * left.inverse();
        let node = |state: Pair<S>, u: S, slope: S, into: &mut [S; 3]| {
            let first = state * mode.rate + Pair::real(u);
            let second = first * mode.rate + Pair::real(slope);
            for (sum, part) in into.iter_mut().zip([state, first, second]) {
                *sum += (part * mode.residue).re * mode.count;
            }
        };
        for ((cell, step), (left, right)) in wave.cells.iter().zip(steps.over(&wave)).zip(&mut ends)
        {
            let per_second = 1.0 / cell.length_s;
            node(state, cell.powers[0], cell.powers[1] * per_second, left);
            state = step.step(state, &cell.powers, cell.length_s);
            let one = S::constant(1.0);
            node(state, cell.at(one), cell.slope(one) * per_second, right);
        }
    }
    let cells = wave.cells.iter().zip(ends).map(|(cell, (left, right))| {
        let h = cell.length_s;
        let scaled = |[value, first, second]: [S; 3]| [value, first * h, second * (h * h)];
        Cell { powers: through(scaled(left), scaled(right)), ..*cell }
    });
    Wave { cells: cells.collect(), period_s: wave.period_s }
}

/// The step of a mode over each cell: whole cells share theirs.
struct Steps<S> {
    whole: Option<Relaxation<Pair<S>>>,
    others: Vec<Relaxation<Pair<S>>>,
}

impl<S: Scalar> Steps<S> {
    fn new(mode: &Mode<S>, wave: &Wave<S>) -> Self {
        let new = |cell: &Cell<S>| {
            let rate = Pair::new(-mode.rate.re, -mode.rate.im);
            Relaxation::complex(rate.scaled(S::constant(cell.length_s)))
        };
        Self {
            whole: wave.cells.iter().find(|cell| cell.whole.is_some()).map(new),
            others: wave.cells.iter().filter(|cell| cell.whole.is_none()).map(new).collect(),
        }
    }

    /// The steps in the order of the cells.
    fn over<'a>(&'a self, wave: &'a Wave<S>) -> impl Iterator<Item = &'a Relaxation<Pair<S>>> {
        let mut others = self.others.iter();
        wave.cells.iter().filter_map(move |cell| match cell.whole {
            Some(_) => self.whole.as_ref(),
            None => others.next(),
        })
    }
}

/// The wave with cells behind a kink so short that a quintic follows what the
/// kink excites in real modes.
fn layered<S: Scalar>(wave: Wave<S>, modes: &[Mode<S>]) -> Wave<S> {
    let rates: Vec<f64> = modes
        .iter()
        .filter(|mode| mode.rate.im.value() == 0.0)
        .map(|mode| -mode.rate.re.value())
        .collect();
    let longest = wave.cells.iter().map(|cell| cell.length_s).fold(0.0, f64::max);
    if rates.iter().all(|rate| rate * longest <= RADIANS_PER_CELL) {
        return wave;
    }
    let allowed = |since: f64| {
        let allow = |rate: &f64| match rate * since {
            past if past > LAYER_END => f64::INFINITY,
            past => RADIANS_PER_CELL.max(LAYER_GROWTH * past) / rate,
        };
        rates.iter().map(allow).fold(f64::INFINITY, f64::min)
    };
    let count = wave.cells.len();
    let steepest = wave.cells.iter().map(|c| c.number_slope(0.0).abs() / c.length_s);
    let steepest = steepest.fold(0.0, f64::max);
    let kink = |i: usize| {
        let (before, here) = (&wave.cells[(i + count - 1) % count], &wave.cells[i]);
        let jump =
            before.number_slope(1.0) / before.length_s - here.number_slope(0.0) / here.length_s;
        jump.abs() > 1e-6 * steepest
    };
    // Begin at the last kink before the period, as seen from its start.
    let last = (0..count).rev().find(|i| kink(*i));
    let mut since = last.map_or(f64::INFINITY, |i| wave.period_s - wave.cells[i].from_s);
    let mut cells = Vec::with_capacity(2 * count);
    for (i, cell) in wave.cells.iter().enumerate() {
        if kink(i) {
            since = 0.0;
        }
        let mut from = 0.0;
        while from < 1.0 {
            let share = allowed(since) / cell.length_s;
            // No sliver at the end of the cell.
            let to = if from + 1.2 * share >= 1.0 { 1.0 } else { from + share };
            cells.push(if from == 0.0 && to == 1.0 { *cell } else { cell.part(from, to) });
            since += (to - from) * cell.length_s;
            from = to;
        }
    }
    Wave { cells, period_s: wave.period_s }
}

#[cfg(test)]
mod tests;
