//! The torque behind the actuator in the periodic steady state: the input passes through static
//! maps, a rate limiter and the actuator.
//!
//! The input is a piecewise quintic. Static maps are piecewise linear: cells are split where the
//! slope of a map changes, and the map is exact on each part. The rate limiter replaces parts by
//! ramps. The response of the actuator's modes (`modal`) to each part is exact. All signals are
//! continuous, so that the positions of the splits need no derivatives by the parameters.

mod modal;

use crate::effects::{Axis, InputMap};
use crate::measurement::Complex;
use crate::plant::{Actuator, Dual, Scalar};

use super::rate_limit;
use crate::simulate::base::sensitivity::actuator_derivatives;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic, Quintic};
pub(crate) use modal::{Mode, modes};
use modal::{RADIANS_PER_CELL, actuator_output};

/// Above this ratio of its natural frequency to the highest frequency of the input, an oscillatory
/// actuator (ζ < 2) is treated as a delay. This changes the torque by a millionth, and the velocity
/// by less.
const DELAY_FREQUENCY_RATIO: f64 = 1000.0;

/// The torque on the mechanics, and the grid of its cells. For a cosine the grid has at least
/// `fewest` cells.
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
    // An oscillatory actuator needs cells as short as its oscillation; for a well-damped one
    // (ζ ≥ 2), short cells behind each kink suffice (`modal`).
    let ringing = match actuator.map(Scalar::value) {
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } if damping_ratio < 2.0 => {
            natural_frequency_rad_s
        }
        _ => 0.0,
    };
    // A delay commutes with static maps and rate limiter: such an actuator may act ahead of them.
    let highest = omega * (excitation.input().len() - 1) as f64;
    let delays = ringing > DELAY_FREQUENCY_RATIO * highest;
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
    let mut forcing = linear(ahead, excitation, grid);
    for map in &axis.input_maps {
        forcing = mapped(&forcing, map);
    }
    if let Some(rate) = axis.rate_limit {
        forcing = rate_limit::limited(&forcing, rate);
    }
    (actuator_output(behind, forcing), grid)
}

/// The derivatives of a torque, cell by cell, by each lane by which it has any.
pub(crate) struct TorqueDerivatives {
    /// The lane, and the derivative of the coefficients of every cell.
    pub by_lane: Vec<(usize, Vec<Quintic<f64>>)>,
}

impl TorqueDerivatives {
    /// Of a torque without derivatives.
    pub const NONE: Self = Self { by_lane: Vec::new() };
}

/// The torque and its derivatives apart, for an axis with many lanes. The torque depends only on
/// the few parameters of actuator, maps and rate limiter, and is computed with their lanes alone.
pub(crate) fn torque_and_derivatives<'e, const N: usize>(
    axis: &Axis<Dual<N>>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (PiecewiseQuintic<f64>, TorqueDerivatives, &'e Grid) {
    let (mut forcing, mut by_lane) = (None, Vec::new());
    let lanes = lanes_of_torque(axis);
    for lanes in lanes.chunks(FEW_LANES) {
        let few = with_lanes(axis, lanes);
        let (lifted, grid) = torque(&few, excitation, fewest);
        for (i, lane) in lanes.iter().enumerate() {
            let of = |cell: &Cell<Dual<FEW_LANES>>| cell.powers.map(|power| power.lane(i));
            by_lane.push((*lane, lifted.cells.iter().map(of).collect()));
        }
        forcing.get_or_insert_with(|| (lifted.map(Dual::value), grid));
    }
    let (forcing, grid) =
        forcing.unwrap_or_else(|| torque(&axis.map(Dual::value), excitation, fewest));
    (forcing, TorqueDerivatives { by_lane }, grid)
}

/// The same together, in dual numbers as wide as those of the axis.
pub(crate) fn torque_of_few<'e, const N: usize>(
    axis: &Axis<Dual<N>>,
    excitation: &'e Excitation,
    fewest: usize,
) -> (PiecewiseQuintic<Dual<N>>, &'e Grid) {
    let lanes = lanes_of_torque(axis);
    if lanes.len() > FEW_LANES {
        return torque(axis, excitation, fewest);
    }
    let (forcing, grid) = torque(&with_lanes(axis, &lanes), excitation, fewest);
    let mut place = [FEW_LANES; N];
    lanes.iter().enumerate().for_each(|(i, lane)| place[*lane] = i);
    (forcing.map(|x| Dual::with_lanes(x.value(), |lane| x.lane(place[lane]))), grid)
}

/// The lanes by which the torque has derivatives.
fn lanes_of_torque<const N: usize>(axis: &Axis<Dual<N>>) -> Vec<usize> {
    let mut ahead: Vec<Dual<N>> = axis.rate_limit.into_iter().collect();
    let _ = axis.plant.actuator.map(|value| ahead.push(value));
    for map in &axis.input_maps {
        ahead.extend(map.breaks.iter().chain(&map.slopes));
    }
    (0..N).filter(|lane| ahead.iter().any(|value| value.lane(*lane) != 0.0)).collect()
}

/// The axis with a few of its lanes.
fn with_lanes<const N: usize>(axis: &Axis<Dual<N>>, lanes: &[usize]) -> Axis<Dual<FEW_LANES>> {
    axis.map(|x| {
        Dual::with_lanes(x.value(), |lane| lanes.get(lane).map_or(0.0, |lane| x.lane(*lane)))
    })
}

/// Most lanes for which the torque is computed at once.
const FEW_LANES: usize = 4;

/// A(s)·u without maps and rate limiter.
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

/// The signal behind a static map.
fn mapped<S: Scalar>(forcing: &PiecewiseQuintic<S>, map: &InputMap<S>) -> PiecewiseQuintic<S> {
    let mut cells = Vec::with_capacity(forcing.cells.len() + 8);
    let breaks: Vec<f64> = map.breaks.iter().map(|at| at.value()).collect();
    let pieces: Vec<(S, S)> = (0..map.slopes.len()).map(|i| map.piece(i)).collect();
    for cell in &forcing.cells {
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
    PiecewiseQuintic { cells, period_s: forcing.period_s }
}

/// The positions at which a cell crosses a level, in either direction: at most two.
fn crossings<S: Scalar>(cell: &Cell<S>, level: f64) -> Vec<f64> {
    let start = cell.number(0.0) - level;
    let sign = if start > 0.0 { -1.0 } else { 1.0 };
    let Some(first) = cell.crossing(0.0, level, sign) else { return vec![] };
    // If both ends are on the same side of the level, there is a second crossing.
    let returns = sign * (cell.number(1.0) - level) < 0.0;
    let second = if returns { cell.crossing(first, level, -sign) } else { None };
    std::iter::once(first).chain(second).collect()
}

#[cfg(test)]
mod tests;
