//! Exact steps of mechanics that are affine between switches: x' = A·x + b·τ + d.
//!
//! τ is a quintic over the step, with coefficients τₘ. The solution over a step of length h has the
//! power series c₀ = x, cₘ₊₁ = (A·cₘ + b·τₘ + d·[m = 0])·h/(m + 1). It is summed to rounding, so
//! that a step has no truncation error. For a step length that occurs often the sums are cached as
//! matrices: x goes to Φx + Σ τᵢΓᵢ + δ, where Φ is the matrix exponential of A·h. A, b and d are
//! found by evaluating the equations of motion at unit vectors.

use crate::plant::Scalar;

use super::mechanics::{Mechanics, Mode};
use super::runge_kutta::Vector;
use super::series::Series;
use crate::simulate::signal::piecewise_quintic::Quintic;

/// Longest step as a multiple of the inverse of the fastest rate: `SERIES_TERMS` terms suffice.
pub(super) const LONGEST_RATE_TIMES_STEP: f64 = 1.2;

/// Terms of the series; the last one is at most 1.2²⁰/20! = 2e-17.
pub(super) const SERIES_TERMS: usize = 20;

/// Columns of a square matrix.
pub(super) type Matrix<S, const M: usize> = [Vector<S, M>; M];

/// The equations of one mode: A, b and d.
pub(super) struct Affine<S, const M: usize> {
    pub mode: Mode,
    /// Columns of A.
    pub matrix: Matrix<S, M>,
    /// b.
    pub by_torque: Vector<S, M>,
    /// d.
    pub constant: Vector<S, M>,
    cached: Option<StepMatrices<S, M>>,
}

/// The matrices of a step of one length.
pub(super) struct StepMatrices<S, const M: usize> {
    pub length_s: f64,
    /// Columns of Φ.
    pub propagator: Matrix<S, M>,
    /// Γ₀ … Γ₅.
    pub gains: [Vector<S, M>; 6],
    /// δ.
    pub drift: Vector<S, M>,
}

impl<S: Scalar, const M: usize> Affine<S, M> {
    pub fn new(mechanics: &Mechanics<S>, mode: Mode) -> Self {
        let zero = S::constant(0.0);
        let rest = [zero; M];
        let constant = mechanics.linear_slope(mode, zero, &rest);
        let minus_constant = |slope: Vector<S, M>| {
            let mut left = slope;
            left.iter_mut().zip(&constant).for_each(|(value, at_rest)| *value -= *at_rest);
            left
        };
        let by_torque = minus_constant(mechanics.linear_slope(mode, S::constant(1.0), &rest));
        let mut matrix = [rest; M];
        for (i, column) in matrix.iter_mut().enumerate() {
            *column = minus_constant(mechanics.linear_slope(mode, zero, &unit(i)));
        }
        Self { mode, matrix, by_torque, constant, cached: None }
    }

    /// Converts every coefficient with `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> Affine<T, M> {
        Affine {
            mode: self.mode,
            matrix: self.matrix.map(|column| column.map(&f)),
            by_torque: self.by_torque.map(&f),
            constant: self.constant.map(&f),
            cached: None,
        }
    }

    /// δ of a step of this length, for a constant d.
    pub fn drift(&self, constant: &Vector<S, M>, length_s: f64) -> Vector<S, M> {
        let zero = S::constant(0.0);
        self.series(&[zero; M], &[zero; 6], constant, length_s)
    }

    /// The matrices of a step of this length.
    pub fn matrices_of_step(&self, length_s: f64) -> StepMatrices<S, M> {
        let (zero, no_torque) = ([S::constant(0.0); M], [S::constant(0.0); 6]);
        StepMatrices {
            length_s,
            propagator: std::array::from_fn(|i| self.series(&unit(i), &no_torque, &zero, length_s)),
            gains: std::array::from_fn(|i| self.series(&zero, &unit(i), &zero, length_s)),
            drift: self.drift(&self.constant, length_s),
        }
    }

    fn series(
        &self,
        state: &Vector<S, M>,
        powers: &Quintic<S>,
        constant: &Vector<S, M>,
        length_s: f64,
    ) -> Vector<S, M> {
        let (mut term, mut sum) = (*state, *state);
        for m in 0..SERIES_TERMS {
            term = self.next_term(m, &term, powers, constant, length_s);
            add(&mut sum, &term);
        }
        sum
    }

    /// Term m + 1 of the series from term m.
    #[inline(always)]
    pub fn next_term(
        &self,
        m: usize,
        term: &Vector<S, M>,
        powers: &Quintic<S>,
        constant: &Vector<S, M>,
        length_s: f64,
    ) -> Vector<S, M> {
        let mut next = times(&self.matrix, term);
        if let Some(power) = powers.get(m) {
            add(&mut next, &scaled(&self.by_torque, *power));
        }
        if m == 0 {
            add(&mut next, constant);
        }
        let factor = length_s / (m + 1) as f64;
        next.iter_mut().for_each(|value| *value = *value * factor);
        next
    }

    /// Derivative of the state by time.
    #[inline]
    pub fn slope(&self, state: &Vector<S, M>, torque: S) -> Vector<S, M> {
        let mut slope = self.constant;
        add(&mut slope, &times(&self.matrix, state));
        add(&mut slope, &scaled(&self.by_torque, torque));
        slope
    }

    /// Derivative of the slope by time.
    #[inline]
    pub fn curvature(&self, slope: &Vector<S, M>, torque_rate: S) -> Vector<S, M> {
        let mut curvature = times(&self.matrix, slope);
        add(&mut curvature, &scaled(&self.by_torque, torque_rate));
        curvature
    }
}

impl<const M: usize> Affine<f64, M> {
    /// The state after a step under the torque `powers`. `reuse` caches the matrices of the step
    /// for later steps of the same length.
    #[inline]
    pub fn step(
        &mut self,
        state: &Vector<f64, M>,
        powers: &Quintic<f64>,
        length_s: f64,
        reuse: bool,
    ) -> Vector<f64, M> {
        if !reuse {
            return self.series(state, powers, &self.constant, length_s);
        }
        if self.cached.as_ref().is_none_or(|cached| cached.length_s != length_s) {
            self.cached = Some(self.matrices_of_step(length_s));
        }
        let Some(cached) = &self.cached else { return *state };
        let mut end = cached.drift;
        for (column, value) in cached.propagator.iter().zip(state) {
            add(&mut end, &scaled(column, *value));
        }
        for (gain, power) in cached.gains.iter().zip(powers) {
            add(&mut end, &scaled(gain, *power));
        }
        end
    }

    /// A step by Taylor series over `length_s`, or over the part of it in which no state errs by
    /// more than `allowed`. `nonlinear` gives the next term of the nonlinear torques from the terms
    /// of the states so far.
    #[inline]
    pub fn reach(
        &self,
        state: &Vector<f64, M>,
        powers: &Quintic<f64>,
        length_s: f64,
        allowed: &[f64; M],
        mut nonlinear: Option<impl FnMut(&[Vector<f64, M>]) -> f64>,
    ) -> Series<M> {
        Series::new(state, length_s, allowed, nonlinear.is_some(), |terms| {
            let m = terms.len() - 1;
            let mut next = self.next_term(m, &terms[m], powers, &self.constant, length_s);
            if let Some(nonlinear) = &mut nonlinear {
                let torque = nonlinear(terms) * (-length_s / (m + 1) as f64);
                add(&mut next, &scaled(&self.by_torque, torque));
            }
            next
        })
    }
}

/// The vector that is 1 at one entry.
fn unit<S: Scalar, const L: usize>(i: usize) -> [S; L] {
    let mut unit = [S::constant(0.0); L];
    unit[i] = S::constant(1.0);
    unit
}

#[inline(always)]
fn scaled<S: Scalar, const M: usize>(vector: &Vector<S, M>, factor: S) -> Vector<S, M> {
    let mut product = *vector;
    product.iter_mut().for_each(|value| *value = *value * factor);
    product
}

#[inline(always)]
fn add<S: Scalar, const M: usize>(sum: &mut Vector<S, M>, vector: &Vector<S, M>) {
    sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum += *value);
}

#[inline(always)]
fn times<S: Scalar, const M: usize>(matrix: &Matrix<S, M>, vector: &Vector<S, M>) -> Vector<S, M> {
    let mut product = scaled(&matrix[0], vector[0]);
    for (column, value) in matrix.iter().zip(vector).skip(1) {
        add(&mut product, &scaled(column, *value));
    }
    product
}
