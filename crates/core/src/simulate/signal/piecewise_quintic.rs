//! A periodic signal in pieces, each a quintic in time.
//!
//! A period is divided into the cells of a uniform grid, and a cell is divided further at a kink of
//! the signal. The quintic matches the value and two derivatives at both ends of a cell. For a
//! sinusoid with n cells per cycle its error is (2π/n)⁶/46080 of the amplitude.

use std::ops::{Mul, Sub};

use crate::measurement::Complex;
use crate::plant::Scalar;

use super::complex_dual::ComplexDual;
use super::grid::Grid;
use super::root_finding::{bisect, root};
use super::samples::Samples;

/// Coefficients of a quintic, lowest power first.
pub(crate) type Quintic<S> = [S; 6];

/// A piece of the signal, on which u runs from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell<S> {
    /// Start, seconds.
    pub from_s: f64,
    /// Length, seconds.
    pub length_s: f64,
    /// Coefficients of the signal as a polynomial in u.
    pub powers: Quintic<S>,
    /// Index of the grid cell, if the piece is a whole cell.
    pub whole: Option<usize>,
}

impl<S: Scalar> Cell<S> {
    /// The signal at u.
    #[inline]
    pub fn at(&self, u: S) -> S {
        value(&self.powers, u)
    }

    /// The signal at a position without derivatives.
    #[inline]
    pub fn fixed(&self, u: f64) -> S {
        polynomial(&self.powers, u)
    }

    /// Its derivative by u.
    #[inline]
    pub fn slope(&self, u: S) -> S {
        slope(&self.powers, u)
    }

    /// The value at u, without derivatives by parameters.
    #[inline]
    pub fn number(&self, u: f64) -> f64 {
        self.powers.iter().rev().fold(0.0, |sum, c| sum * u + c.value())
    }

    /// The derivative by u, without derivatives by parameters.
    #[inline]
    pub fn number_slope(&self, u: f64) -> f64 {
        (1..6).rev().fold(0.0, |sum, i| sum * u + i as f64 * self.powers[i].value())
    }

    /// The part between two positions as a cell of its own.
    pub fn part(&self, from: f64, to: f64) -> Self {
        if from == 0.0 && to == 1.0 {
            return *self;
        }
        Self {
            from_s: self.from_s + from * self.length_s,
            length_s: (to - from) * self.length_s,
            powers: restricted(&self.powers, from, to),
            whole: None,
        }
    }

    /// End, seconds.
    pub fn end_s(&self) -> f64 {
        self.from_s + self.length_s
    }

    /// The first position after `after` at which the signal crosses `level`, upwards (`sign` = +1)
    /// or downwards (−1).
    pub fn crossing(&self, after: f64, level: f64, sign: f64) -> Option<f64> {
        let above = |u: f64| sign * (self.number(u) - level);
        if above(1.0) > 0.0 {
            return Some(root(after, 1.0, above, |u| sign * self.number_slope(u)));
        }
        // The signal may still cross the level between the ends, if its extremum lies beyond it.
        // The tangents at both ends bound the extremum.
        let rises = |u: f64| sign * self.number_slope(u);
        let (begins, ends) = (rises(after), rises(1.0));
        if !(begins > 0.0 && ends < 0.0) {
            return None;
        }
        let reach = (above(after) + begins * (1.0 - after)).min(above(1.0) - ends * (1.0 - after));
        if reach <= 0.0 {
            return None;
        }
        let top = bisect(after, 1.0, |u| rises(u) > 0.0);
        (above(top) > 0.0).then(|| root(after, top, above, |u| sign * self.number_slope(u)))
    }
}

/// A quintic at u.
#[inline]
pub(crate) fn value<S: Scalar>(powers: &Quintic<S>, u: S) -> S {
    let [a, b, c, d, e, f] = *powers;
    ((((f * u + e) * u + d) * u + c) * u + b) * u + a
}

/// A polynomial of any degree at u.
#[inline]
pub(crate) fn polynomial<S: Scalar>(powers: &[S], u: f64) -> S {
    let mut sum = S::constant(0.0);
    for power in powers.iter().rev() {
        sum = sum * u + *power;
    }
    sum
}

/// Its derivative by u.
#[inline]
pub(crate) fn slope<S: Scalar>(powers: &Quintic<S>, u: S) -> S {
    let [_, b, c, d, e, f] = *powers;
    (((f * 5.0 * u + e * 4.0) * u + d * 3.0) * u + c * 2.0) * u + b
}

/// Coefficients of a quintic on the part from `from` to `to`, positions with or without
/// derivatives.
pub(crate) fn restricted<S, T>(powers: &Quintic<S>, from: T, to: T) -> Quintic<S>
where
    S: Scalar + Mul<T, Output = S>,
    T: Copy + Sub<Output = T> + Mul<Output = T>,
{
    let mut shifted = *powers;
    // Repeated Horner's scheme gives the Taylor coefficients at `from`.
    for i in 0..5 {
        for j in (i..5).rev() {
            let above = shifted[j + 1];
            shifted[j] += above * from;
        }
    }
    let width = to - from;
    let mut scale = width;
    for power in &mut shifted[1..] {
        *power = *power * scale;
        scale = scale * width;
    }
    shifted
}

/// The quintic through value, slope and curvature (by u) at both ends.
#[inline]
pub(crate) fn through<S: Scalar>(left: [S; 3], right: [S; 3]) -> Quintic<S> {
    let [y, d, e] = left;
    let half = e * 0.5;
    // Differences at the right end from the parabola through the left end.
    let value = right[0] - y - d - half;
    let slope = right[1] - d - e;
    let curvature = right[2] - e;
    [
        y,
        d,
        half,
        value * 10.0 - slope * 4.0 + curvature * 0.5,
        slope * 7.0 - value * 15.0 - curvature,
        value * 6.0 - slope * 3.0 + curvature * 0.5,
    ]
}

/// A periodic signal, or one over a time record.
#[derive(Debug, Clone)]
pub(crate) struct PiecewiseQuintic<S> {
    /// Pieces in order, from time 0 to the period.
    pub cells: Vec<Cell<S>>,
    /// Period, or length of the record, seconds.
    pub period_s: f64,
}

impl<S: Scalar> PiecewiseQuintic<S> {
    /// From the value and two derivatives by time at every sample of the grid, 0 … N.
    fn of_nodes(grid: &Grid, period_s: f64, node: impl Fn(usize) -> [S; 3]) -> Self {
        let count = grid.samples();
        let h = period_s / count as f64;
        let scaled = |n: usize| {
            let [value, first, second] = node(n);
            [value, first * h, second * (h * h)]
        };
        let mut left = scaled(0);
        let cells = (0..count)
            .map(|n| {
                let right = scaled(n + 1);
                let powers = through(left, right);
                left = right;
                Cell { from_s: n as f64 * h, length_s: h, powers, whole: Some(n) }
            })
            .collect();
        Self { cells, period_s }
    }

    /// Re X·exp(jωt).
    pub fn cosine(grid: &Grid, omega: f64, line: ComplexDual<S>) -> Self {
        Self::of_nodes(grid, std::f64::consts::TAU / omega, |n| {
            let at = line * grid.turn(n);
            [at.re, at.im * -omega, at.re * (-omega * omega)]
        })
    }

    /// Re Σ Xₗ exp(jlωt) with derivatives. `derivatives` holds parameters and the derivatives of
    /// the lines by them.
    pub fn of_lines(
        grid: &Grid,
        omega: f64,
        lines: &[Complex],
        derivatives: &[(S, Vec<Complex>)],
    ) -> Self {
        let (signal, _) = Samples::of(grid, omega, lines, &[]);
        let changes: Vec<(S, Samples)> = derivatives
            .iter()
            .map(|(by, lines)| (*by, Samples::of(grid, omega, lines, &[]).0))
            .collect();
        let combine = |value: f64, part: &dyn Fn(&Samples) -> f64| {
            S::with_lanes(value, |lane| {
                changes.iter().map(|(by, change)| by.lane(lane) * part(change)).sum()
            })
        };
        Self::of_nodes(grid, std::f64::consts::TAU / omega, |n| {
            [
                combine(signal.value[n], &|s| s.value[n]),
                combine(signal.first[n], &|s| s.first[n]),
                combine(signal.second[n], &|s| s.second[n]),
            ]
        })
    }

    /// Converts every coefficient with `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> PiecewiseQuintic<T> {
        let cells = self.cells.iter().map(|cell| Cell {
            from_s: cell.from_s,
            length_s: cell.length_s,
            powers: cell.powers.map(&f),
            whole: cell.whole,
        });
        PiecewiseQuintic { cells: cells.collect(), period_s: self.period_s }
    }

    /// Smallest and largest value.
    pub fn range(&self) -> (f64, f64) {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for cell in &self.cells {
            let (start, end) = (cell.number_slope(0.0), cell.number_slope(1.0));
            let top = (start * end < 0.0)
                .then(|| bisect(0.0, 1.0, |u| cell.number_slope(u) * start > 0.0));
            for u in [Some(0.0), top].into_iter().flatten() {
                let value = cell.number(u);
                range = (range.0.min(value), range.1.max(value));
            }
        }
        range
    }
}
