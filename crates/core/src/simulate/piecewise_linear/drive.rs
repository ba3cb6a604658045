//! From the input to the torque behind the actuator, through static maps and a rate limiter.
//!
//! The input is a piecewise quintic. Static maps are piecewise linear: they split the pieces where
//! their slope changes, and act on each part exactly. The rate limiter replaces parts by ramps. The
//! actuator's modes (`modal`) answer each part exactly, from their own periodic state. All signals are
//! continuous, so that a split which moves with a parameter has no derivative of its own.

mod modal;

use crate::effects::{Axis, InputMap};
use crate::measurement::Complex;
use crate::plant::{Actuator, Dual, Scalar};

use super::rate_limit;
use crate::simulate::base::sensitivity::actuator_derivatives;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic};
pub(crate) use modal::{Mode, modes};
use modal::{RADIANS_PER_CELL, delivered};

/// Natural frequency, in the highest frequency of the input, above which an actuator that
/// rings is a delay: of the torque it changes a millionth, and of the velocity less.
const FAST: f64 = 1000.0;

/// The torque on the mechanics, and the grid of its cells: at least `fewest` of
/// them for a period of a cosine.
pub(crate) fn torque<'e, S: Scalar>(
    axis: &Axis<S>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (PiecewiseQuintic<S>, &'e Grid) {
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
pub(crate) fn torque_of_few<'e, const N: usize>(
    axis: &Axis<Dual<N>>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (PiecewiseQuintic<Dual<N>>, &'e Grid) {
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
fn linear<S: Scalar>(
    actuator: &Actuator<S>,
    excitation: &Excitation,
    grid: &Grid,
) -> PiecewiseQuintic<S> {
    let omega = excitation.omega_rad_s();
    if excitation.is_pure_cosine() {
        let line = response(actuator, omega) * excitation.input()[1];
        return PiecewiseQuintic::cosine(grid, omega, line);
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
    PiecewiseQuintic::of_lines(grid, omega, &lines, &derivatives)
}

/// A(jω).
pub(crate) fn response<S: Scalar>(actuator: &Actuator<S>, omega: f64) -> ComplexDual<S> {
    let one = S::constant(1.0);
    match *actuator {
        Actuator::Direct => ComplexDual::real(one),
        Actuator::FirstOrder { corner_rad_s: p } => {
            ComplexDual::new(p, S::constant(omega)).inverse().scaled(p)
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            let square = wn * wn;
            let denominator = ComplexDual::new(square - omega * omega, zeta * wn * (2.0 * omega));
            denominator.inverse().scaled(square)
        }
    }
}

/// The wave behind a static map.
fn mapped<S: Scalar>(wave: &PiecewiseQuintic<S>, map: &InputMap<S>) -> PiecewiseQuintic<S> {
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
    PiecewiseQuintic { cells, period_s: wave.period_s }
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

#[cfg(test)]
mod tests;
