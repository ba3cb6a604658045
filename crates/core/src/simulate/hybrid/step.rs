//! A completed step of any method: its length, its end, and the polynomial over it.

use super::runge_kutta::{Stages, Vector};
use super::series::{MOST_POWERS, Series};
use crate::simulate::signal::piecewise_quintic::{Quintic, polynomial, through};

/// A step of a motion.
pub(super) enum Step<const M: usize> {
    /// By Runge–Kutta stages.
    Stages(Stages<f64, M>),
    /// By Taylor series.
    Series(Series<M>),
    /// Exact, known at its ends.
    Ends(Ends<M>),
}

/// The exact ends of a step.
pub(super) struct Ends<const M: usize> {
    pub length_s: f64,
    pub states: [Vector<f64, M>; 2],
    /// Derivatives by time.
    pub slopes: [Vector<f64, M>; 2],
    /// Second derivatives by time, if v is needed between the ends.
    pub curvatures: Option<[Vector<f64, M>; 2]>,
    /// Whether the length occurs often, so that the matrices of the step are cached.
    pub repeats: bool,
}

/// One state over a step as a polynomial in u, which goes from 0 to 1.
#[derive(Clone, Copy)]
pub(super) struct Powers {
    powers: [f64; MOST_POWERS],
    count: usize,
}

impl Powers {
    fn new(some: &[f64]) -> Self {
        let mut powers = [0.0; MOST_POWERS];
        powers[..some.len()].copy_from_slice(some);
        Self { powers, count: some.len() }
    }

    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        polynomial(self.all(), u)
    }

    /// At several positions, side by side.
    #[inline]
    pub fn at_each<const P: usize>(&self, positions: &[f64; P]) -> [f64; P] {
        let mut sums = [0.0; P];
        for power in self.all().iter().rev() {
            sums.iter_mut().zip(positions).for_each(|(sum, u)| *sum = *sum * u + power);
        }
        sums
    }

    /// The coefficients, lowest power first.
    pub fn all(&self) -> &[f64] {
        &self.powers[..self.count]
    }
}

impl<const M: usize> Step<M> {
    /// State at the end.
    pub fn end(&self) -> &Vector<f64, M> {
        match self {
            Step::Stages(stages) => &stages.end,
            Step::Series(series) => &series.end,
            Step::Ends(ends) => &ends.states[1],
        }
    }

    /// Length, seconds.
    pub fn length_s(&self) -> f64 {
        match self {
            Step::Stages(stages) => stages.length_s,
            Step::Series(series) => series.length_s,
            Step::Ends(ends) => ends.length_s,
        }
    }

    /// Derivative by time at the end.
    pub fn end_slope(&self) -> &Vector<f64, M> {
        match self {
            Step::Stages(stages) => &stages.slopes[6],
            Step::Series(series) => &series.end_slope,
            Step::Ends(ends) => &ends.slopes[1],
        }
    }

    /// Whether state `i` certainly does not reach `level` within the step.
    #[inline]
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        match self {
            Step::Stages(Stages { length_s, start, end, slopes }) => {
                cubic_stays_beyond([start, end], [&slopes[0], &slopes[6]], *length_s, i, level)
            }
            Step::Series(series) => series.stays_beyond(i, level),
            Step::Ends(ends) => ends.stays_beyond(i, level),
        }
    }

    /// State `i` over the step.
    #[inline]
    pub fn numbers(&self, i: usize) -> Powers {
        match self {
            Step::Stages(stages) => Powers::new(&stages.powers(i)),
            Step::Series(series) => Powers::new(&series.powers(i)),
            Step::Ends(ends) => Powers::new(&ends.powers(i)),
        }
    }
}

impl<const M: usize> Ends<M> {
    /// Whether state `i` certainly does not reach `level` within the step.
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        let [[start, end], [first, last]] = [&self.states, &self.slopes];
        cubic_stays_beyond([start, end], [first, last], self.length_s, i, level)
    }

    /// Coefficients of state `i` over the step.
    #[inline]
    pub fn powers(&self, i: usize) -> Quintic<f64> {
        let h = self.length_s;
        let [start, end] = [0, 1].map(|at| self.states[at][i]);
        let [first, last] = [0, 1].map(|at| self.slopes[at][i] * h);
        let [begin, finish] = match &self.curvatures {
            Some(both) => [0, 1].map(|at| both[at][i] * (h * h)),
            None => {
                // Second derivatives of the cubic through values and slopes.
                let mean = (end - start) * 3.0;
                [(mean - first * 2.0 - last) * 2.0, (first + last * 2.0 - mean) * 2.0]
            }
        };
        through([start, first, begin], [end, last, finish])
    }
}

/// Whether the cubic through values and slopes at both ends certainly does not reach `level`. It
/// leaves the interval between the end values by at most 4/27 of the sum of |slope|·length; 0.2 is
/// safe.
#[inline]
fn cubic_stays_beyond<const M: usize>(
    [start, end]: [&Vector<f64, M>; 2],
    [first, last]: [&Vector<f64, M>; 2],
    length_s: f64,
    i: usize,
    level: f64,
) -> bool {
    let (start, end) = (start[i] - level, end[i] - level);
    let departs = 0.2 * (first[i].abs() + last[i].abs()) * length_s;
    start * end > 0.0 && start.abs().min(end.abs()) > departs
}
