//! The actuator's periodic response to a piecewise quintic, by modal decomposition: each mode is a
//! first-order lag with a real or complex rate, whose response to a quintic is exact.

use crate::plant::{Actuator, Scalar};

use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic, through};

/// Largest angle (or number of time constants) of a mode in one cell. The quintic then misses 7e-5
/// of the oscillation after a kink, which is itself at most a hundredth of the torque.
pub(crate) const RADIANS_PER_CELL: f64 = 1.2;

/// Longest cell behind a kink, as a multiple of the time since the kink, while the modes that it
/// excited decay. Tuned.
const LAYER_GROWTH: f64 = 1.5;

/// Time constants after which such a mode has decayed: exp(−14) = 8e-7.
const LAYER_END: f64 = 14.0;

/// A first-order mode η' = λη + u of the actuator, which adds Re(residue·η)·count to τ.
#[derive(Clone, Copy)]
pub(crate) struct Mode<S> {
    /// λ, 1/s.
    pub rate: ComplexDual<S>,
    pub residue: ComplexDual<S>,
    /// 2 for a complex mode, whose conjugate adds the same; otherwise 1.
    pub count: f64,
}

/// The partial fractions of A(s).
pub(crate) fn modes<S: Scalar>(actuator: &Actuator<S>) -> Vec<Mode<S>> {
    match *actuator {
        Actuator::Direct => vec![],
        Actuator::FirstOrder { corner_rad_s: p } => {
            vec![Mode { rate: ComplexDual::real(-p), residue: ComplexDual::real(p), count: 1.0 }]
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            // A = ωₙ²/((s − λ₁)(s − λ₂)). For a double pole ζ² is changed slightly.
            let mut inside = zeta * zeta - 1.0;
            if inside.value().abs() < 1e-8 {
                inside = inside + 2e-8;
            }
            let real = -(zeta * wn);
            let zero = S::constant(0.0);
            if inside.value() < 0.0 {
                let turning = wn * (-inside).sqrt();
                let residue = ComplexDual::new(zero, -(wn * wn / (turning * 2.0)));
                vec![Mode { rate: ComplexDual::new(real, turning), residue, count: 2.0 }]
            } else {
                let apart = wn * inside.sqrt();
                let residue = wn * wn / (apart * 2.0);
                vec![
                    Mode {
                        rate: ComplexDual::real(real + apart),
                        residue: ComplexDual::real(residue),
                        count: 1.0,
                    },
                    Mode {
                        rate: ComplexDual::real(real - apart),
                        residue: ComplexDual::real(-residue),
                        count: 1.0,
                    },
                ]
            }
        }
    }
}

/// The signal behind the actuator, in the periodic steady state.
pub(crate) fn actuator_output<S: Scalar>(
    actuator: &Actuator<S>,
    forcing: PiecewiseQuintic<S>,
) -> PiecewiseQuintic<S> {
    let modes = modes(actuator);
    if modes.is_empty() {
        return forcing;
    }
    let forcing = refined_behind_kinks(forcing, &modes);
    let zero = S::constant(0.0);
    // τ, τ' and τ'' at both ends of every cell.
    let mut ends = vec![([zero; 3], [zero; 3]); forcing.cells.len()];
    for mode in &modes {
        let steps = Steps::new(mode, &forcing);
        let travelled = forcing
            .cells
            .iter()
            .zip(steps.over(&forcing))
            .fold(ComplexDual::real(zero), |state, (cell, step)| {
                step.step(state, &cell.powers, cell.length_s)
            });
        let kept = mode.rate.scaled(S::constant(forcing.period_s)).exp();
        let left = ComplexDual::new(-kept.re + 1.0, -kept.im);
        let mut state = travelled * left.inverse();
        let node = |state: ComplexDual<S>, u: S, slope: S, into: &mut [S; 3]| {
            let first = state * mode.rate + ComplexDual::real(u);
            let second = first * mode.rate + ComplexDual::real(slope);
            for (sum, part) in into.iter_mut().zip([state, first, second]) {
                *sum += (part * mode.residue).re * mode.count;
            }
        };
        for ((cell, step), (left, right)) in
            forcing.cells.iter().zip(steps.over(&forcing)).zip(&mut ends)
        {
            let per_second = 1.0 / cell.length_s;
            node(state, cell.powers[0], cell.powers[1] * per_second, left);
            state = step.step(state, &cell.powers, cell.length_s);
            let one = S::constant(1.0);
            node(state, cell.at(one), cell.slope(one) * per_second, right);
        }
    }
    let cells = forcing.cells.iter().zip(ends).map(|(cell, (left, right))| {
        let h = cell.length_s;
        let scaled = |[value, first, second]: [S; 3]| [value, first * h, second * (h * h)];
        Cell { powers: through(scaled(left), scaled(right)), ..*cell }
    });
    PiecewiseQuintic { cells: cells.collect(), period_s: forcing.period_s }
}

/// The integrator of a mode for each cell; all whole cells share one.
struct Steps<S> {
    whole: Option<ExponentialIntegrator<ComplexDual<S>>>,
    others: Vec<ExponentialIntegrator<ComplexDual<S>>>,
}

impl<S: Scalar> Steps<S> {
    fn new(mode: &Mode<S>, forcing: &PiecewiseQuintic<S>) -> Self {
        let new = |cell: &Cell<S>| {
            let rate = ComplexDual::new(-mode.rate.re, -mode.rate.im);
            ExponentialIntegrator::complex(rate.scaled(S::constant(cell.length_s)))
        };
        Self {
            whole: forcing.cells.iter().find(|cell| cell.whole.is_some()).map(new),
            others: forcing.cells.iter().filter(|cell| cell.whole.is_none()).map(new).collect(),
        }
    }

    /// The integrators in the order of the cells.
    fn over<'a>(
        &'a self,
        forcing: &'a PiecewiseQuintic<S>,
    ) -> impl Iterator<Item = &'a ExponentialIntegrator<ComplexDual<S>>> {
        let mut others = self.others.iter();
        forcing.cells.iter().filter_map(move |cell| match cell.whole {
            Some(_) => self.whole.as_ref(),
            None => others.next(),
        })
    }
}

/// The same signal, with cells behind each kink divided so that quintics can represent the response
/// of the real modes to the kink.
fn refined_behind_kinks<S: Scalar>(
    forcing: PiecewiseQuintic<S>,
    modes: &[Mode<S>],
) -> PiecewiseQuintic<S> {
    let rates: Vec<f64> = modes
        .iter()
        .filter(|mode| mode.rate.im.value() == 0.0)
        .map(|mode| -mode.rate.re.value())
        .collect();
    let longest = forcing.cells.iter().map(|cell| cell.length_s).fold(0.0, f64::max);
    if rates.iter().all(|rate| rate * longest <= RADIANS_PER_CELL) {
        return forcing;
    }
    let allowed = |since: f64| {
        let allow = |rate: &f64| match rate * since {
            past if past > LAYER_END => f64::INFINITY,
            past => RADIANS_PER_CELL.max(LAYER_GROWTH * past) / rate,
        };
        rates.iter().map(allow).fold(f64::INFINITY, f64::min)
    };
    let count = forcing.cells.len();
    let steepest = forcing.cells.iter().map(|c| c.number_slope(0.0).abs() / c.length_s);
    let steepest = steepest.fold(0.0, f64::max);
    let kink = |i: usize| {
        let (before, here) = (&forcing.cells[(i + count - 1) % count], &forcing.cells[i]);
        let jump =
            before.number_slope(1.0) / before.length_s - here.number_slope(0.0) / here.length_s;
        jump.abs() > 1e-6 * steepest
    };
    // At the start of the period, the time since the last kink of the period before.
    let last = (0..count).rev().find(|i| kink(*i));
    let mut since = last.map_or(f64::INFINITY, |i| forcing.period_s - forcing.cells[i].from_s);
    let mut cells = Vec::with_capacity(2 * count);
    for (i, cell) in forcing.cells.iter().enumerate() {
        if kink(i) {
            since = 0.0;
        }
        let mut from = 0.0;
        while from < 1.0 {
            let share = allowed(since) / cell.length_s;
            // Avoids a very short part at the end of the cell.
            let to = if from + 1.2 * share >= 1.0 { 1.0 } else { from + share };
            cells.push(if from == 0.0 && to == 1.0 { *cell } else { cell.part(from, to) });
            since += (to - from) * cell.length_s;
            from = to;
        }
    }
    PiecewiseQuintic { cells, period_s: forcing.period_s }
}
