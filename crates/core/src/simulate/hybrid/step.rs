//! A completed step of any method: its length, its end, and the polynomial over it.

use crate::plant::Scalar;

use super::runge_kutta::{Stages, Vector};
use super::series::{MOST_POWERS, Series};
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::{Quintic, polynomial, through};

/// A step of a motion.
pub(super) enum Step<S, const M: usize> {
    /// By Runge–Kutta stages.
    Stages(Stages<S, M>),
    /// By Taylor series.
    Series(Series<S, M>),
    /// Exact, known at its ends.
    Ends(Ends<S, M>),
}

/// The exact ends of a step.
pub(super) struct Ends<S, const M: usize> {
    pub length_s: f64,
    pub states: [Vector<S, M>; 2],
    /// Derivatives by time.
    pub slopes: [Vector<S, M>; 2],
    /// Second derivatives by time, if v is needed between the ends.
    pub curvatures: Option<[Vector<S, M>; 2]>,
}

/// One state over a step as a polynomial in u, which goes from 0 to 1; values only, no derivatives.
#[derive(Clone, Copy)]
pub(super) struct Powers {
    powers: [f64; MOST_POWERS],
    count: usize,
}

impl Powers {
    /// Placeholder for a state that is not needed.
    pub const NONE: Self = Self { powers: [0.0; MOST_POWERS], count: 0 };

    fn new(some: &[f64]) -> Self {
        let mut powers = [0.0; MOST_POWERS];
        powers[..some.len()].copy_from_slice(some);
        Self { powers, count: some.len() }
    }

    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        polynomial(self.all(), u)
    }

    /// The coefficients, lowest power first.
    pub fn all(&self) -> &[f64] {
        &self.powers[..self.count]
    }
}

impl<S: Scalar, const M: usize> Step<S, M> {
    /// State at the end.
    pub fn end(&self) -> &Vector<S, M> {
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
    pub fn end_slope(&self) -> &Vector<S, M> {
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

    /// State `i` over the step, without derivatives.
    #[inline]
    pub fn numbers(&self, i: usize) -> Powers {
        match self {
            Step::Stages(stages) => Powers::new(&stages.powers(i, S::value)),
            Step::Series(series) => Powers::new(&series.powers(i, S::value)),
            Step::Ends(ends) => Powers::new(&ends.powers(i, S::value)),
        }
    }

    /// Adds state `i` to the Fourier integrals, over a step that begins at `from_s`, up to position
    /// `reach`.
    pub fn add(&self, i: usize, sums: &mut Fourier<'_, S>, from_s: f64, reach: f64) {
        let same = |x| x;
        match self {
            Step::Stages(s) => {
                sums.add_fixed(from_s, s.length_s, reach, &s.powers(i, same));
            }
            Step::Series(s) => sums.add_fixed(from_s, s.length_s, reach, &s.powers(i, same)),
            Step::Ends(s) => sums.add_fixed(from_s, s.length_s, reach, &s.powers(i, same)),
        }
    }
}

impl<S: Scalar, const M: usize> Ends<S, M> {
    /// Whether state `i` certainly does not reach `level` within the step.
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        let [[start, end], [first, last]] = [&self.states, &self.slopes];
        cubic_stays_beyond([start, end], [first, last], self.length_s, i, level)
    }

    /// Coefficients of state `i` over the step, of the values converted by `part`.
    #[inline]
    pub fn powers<T: Scalar>(&self, i: usize, part: impl Fn(S) -> T) -> Quintic<T> {
        let h = self.length_s;
        let [start, end] = [0, 1].map(|at| part(self.states[at][i]));
        let [first, last] = [0, 1].map(|at| part(self.slopes[at][i]) * h);
        let [begin, finish] = match &self.curvatures {
            Some(both) => [0, 1].map(|at| part(both[at][i]) * (h * h)),
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
fn cubic_stays_beyond<S: Scalar, const M: usize>(
    [start, end]: [&Vector<S, M>; 2],
    [first, last]: [&Vector<S, M>; 2],
    length_s: f64,
    i: usize,
    level: f64,
) -> bool {
    let (start, end) = (start[i].value() - level, end[i].value() - level);
    let departs = 0.2 * (first[i].value().abs() + last[i].value().abs()) * length_s;
    start * end > 0.0 && start.abs().min(end.abs()) > departs
}
