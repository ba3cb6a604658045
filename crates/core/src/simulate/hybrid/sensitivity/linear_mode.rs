//! The equations of one mode with their derivatives: x' = A·x + b·τ + d, and for a lane
//!
//! ```text
//!   δx' = A·δx + δA·x + δb·τ + b·δτ + δd
//! ```
//!
//! Only few lanes change A and b (those of masses, springs and damping), and only those are visited.

use crate::plant::{Dual, Scalar as _};

use super::Lanes;
use crate::simulate::hybrid::affine::{Affine, Matrix, SERIES_TERMS};
use crate::simulate::hybrid::mechanics::{Mechanics, Mode};
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::signal::piecewise_quintic::Quintic;

/// Number of lanes for which the derivatives of matrices are computed together.
const LANES_AT_ONCE: usize = 4;

/// Derivative of the torque over a step by each lane by which it has one.
pub(super) type TorqueLanes = [(usize, Quintic<f64>)];

/// The equations of one mode and their derivatives by N lanes.
pub(super) struct LinearMode<const N: usize, const M: usize> {
    pub mode: Mode,
    affine: Affine<Dual<N>, M>,
    matrix: Matrix<f64, M>,
    by_torque: Vector<f64, M>,
    /// δA and δb of the lanes that have any.
    varying: Vec<Varying<Vector<f64, M>, M>>,
    /// δd.
    constant: Lanes<N, M>,
    cached: Option<CachedStep<N, M>>,
}

/// Derivatives by one lane: of the matrix of the state, and of what multiplies the torque.
struct Varying<T, const M: usize> {
    lane: usize,
    by_state: Matrix<f64, M>,
    by_torque: T,
}

/// A step of one length: x goes to Φx + Σ τᵢΓᵢ + δ (see [`Affine`]).
struct CachedStep<const N: usize, const M: usize> {
    length_s: f64,
    propagator: Matrix<f64, M>,
    gains: [Vector<f64, M>; 6],
    varying: Vec<Varying<[Vector<f64, M>; 6], M>>,
    drift: Lanes<N, M>,
}

impl<const N: usize, const M: usize> LinearMode<N, M> {
    pub fn new(mechanics: &Mechanics<Dual<N>>, mode: Mode) -> Self {
        let affine = Affine::new(mechanics, mode);
        let varying = (0..N).filter_map(|lane| {
            let by_state = affine.matrix.map(|column| column.map(|entry| entry.lane(lane)));
            let by_torque = affine.by_torque.map(|entry| entry.lane(lane));
            let varies = by_state.iter().chain([&by_torque]).flatten().any(|entry| *entry != 0.0);
            varies.then_some(Varying { lane, by_state, by_torque })
        });
        Self {
            mode,
            matrix: affine.matrix.map(|column| column.map(Dual::value)),
            by_torque: affine.by_torque.map(Dual::value),
            varying: varying.collect(),
            constant: affine.constant.map(lanes_of),
            cached: None,
            affine,
        }
    }

    /// δx after a step whose length occurs often, by cached matrices.
    pub fn repeat(
        &mut self,
        length_s: f64,
        start: &Vector<f64, M>,
        lanes: &Lanes<N, M>,
        powers: &Quintic<f64>,
        torque: &TorqueLanes,
    ) -> Lanes<N, M> {
        if self.cached.as_ref().is_none_or(|cached| cached.length_s != length_s) {
            self.cached = Some(self.cached_step(length_s));
        }
        let Some(cached) = &self.cached else { return *lanes };
        let mut end = cached.drift;
        add_product(&mut end, &cached.propagator, lanes);
        for Varying { lane, by_state, by_torque } in &cached.varying {
            for i in 0..M {
                let states = by_state.iter().zip(start).map(|(column, x)| column[i] * x);
                let torques = by_torque.iter().zip(powers).map(|(gain, power)| gain[i] * power);
                end[i][*lane] += states.chain(torques).sum::<f64>();
            }
        }
        for (lane, powers) in torque {
            for i in 0..M {
                let change: f64 = cached.gains.iter().zip(powers).map(|(g, p)| g[i] * p).sum();
                end[i][*lane] += change;
            }
        }
        end
    }

    /// Only the lanes that change A or b need the derivatives of the matrices. The others change δ
    /// in proportion to d.
    fn cached_step(&self, length_s: f64) -> CachedStep<N, M> {
        let step = self.affine.map(Dual::value).matrices_of_step(length_s);
        let mut drift = [[0.0; N]; M];
        let mut varying = Vec::with_capacity(self.varying.len());
        for some in self.varying.chunks(LANES_AT_ONCE) {
            let lane = |i: usize| some.get(i).map(|varying| varying.lane);
            let few = self.affine.map(|x| {
                let of = |i: usize| lane(i).map_or(0.0, |lane| x.lane(lane));
                Dual::<LANES_AT_ONCE>::with_lanes(x.value(), of)
            });
            let step = few.matrices_of_step(length_s);
            for (i, Varying { lane, .. }) in some.iter().enumerate() {
                let of = |vector: &Vector<Dual<LANES_AT_ONCE>, M>| vector.map(|x| x.lane(i));
                let by_state = step.propagator.each_ref().map(of);
                let by_torque = step.gains.each_ref().map(of);
                varying.push(Varying { lane: *lane, by_state, by_torque });
                drift.iter_mut().zip(of(&step.drift)).for_each(|(row, x)| row[*lane] = x);
            }
        }
        for lane in 0..N {
            let constant = self.constant.each_ref().map(|row| row[lane]);
            let is_varying = self.varying.iter().any(|varying| varying.lane == lane);
            if !is_varying && constant.iter().any(|x| *x != 0.0) {
                let mut mode = self.affine.map(Dual::value);
                mode.constant = constant;
                let change = mode.drift(length_s);
                drift.iter_mut().zip(change).for_each(|(row, x)| row[lane] = x);
            }
        }
        let (propagator, gains) = (step.propagator, step.gains);
        CachedStep { length_s, propagator, gains, varying, drift }
    }

    /// δx after a step of any length, by the Taylor series of the motion.
    pub fn series(
        &self,
        length_s: f64,
        start: &Vector<f64, M>,
        lanes: &Lanes<N, M>,
        powers: &Quintic<f64>,
        torque: &TorqueLanes,
    ) -> Lanes<N, M> {
        let constant = self.affine.constant.map(Dual::value);
        let (mut state, mut term, mut sum) = (*start, *lanes, *lanes);
        for m in 0..SERIES_TERMS {
            let driving = powers.get(m).copied().unwrap_or(0.0);
            term = self.next_term(m, &state, &term, (driving, &[0.0; N]), torque, length_s);
            let mut next: Vector<f64, M> = std::array::from_fn(|i| {
                self.by_torque[i] * driving + if m == 0 { constant[i] } else { 0.0 }
            });
            for (column, x) in self.matrix.iter().zip(&state) {
                next.iter_mut().zip(column).for_each(|(entry, factor)| *entry += factor * x);
            }
            state = next.map(|entry| entry * length_s / (m + 1) as f64);
            for (sum, term) in sum.iter_mut().zip(&term) {
                sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
            }
        }
        sum
    }

    /// Term m + 1 of the series of δx, from term m of the state and of δx, and from term m of the
    /// torque that drives them: its value and, beside those of `torque`, its derivatives.
    #[inline]
    pub fn next_term(
        &self,
        m: usize,
        state: &Vector<f64, M>,
        term: &Lanes<N, M>,
        (driving, driving_lanes): (f64, &[f64; N]),
        torque: &TorqueLanes,
        length_s: f64,
    ) -> Lanes<N, M> {
        let mut driving_lanes = *driving_lanes;
        for (lane, powers) in torque {
            driving_lanes[*lane] += powers.get(m).copied().unwrap_or(0.0);
        }
        let mut next = self.moved(state, term, (driving, &driving_lanes));
        if m == 0 {
            add(&mut next, &self.constant);
        }
        let factor = length_s / (m + 1) as f64;
        next.iter_mut().flatten().for_each(|entry| *entry *= factor);
        next
    }

    /// δx' in a state under a torque.
    #[inline]
    pub fn slope(
        &self,
        state: &Vector<f64, M>,
        lanes: &Lanes<N, M>,
        torque: (f64, &[f64; N]),
    ) -> Lanes<N, M> {
        let mut slope = self.moved(state, lanes, torque);
        add(&mut slope, &self.constant);
        slope
    }

    /// A·δx + δA·x + δb·τ + b·δτ; that of x' and τ' is the derivative of x''.
    #[inline]
    pub fn moved(
        &self,
        state: &Vector<f64, M>,
        lanes: &Lanes<N, M>,
        (torque, torque_lanes): (f64, &[f64; N]),
    ) -> Lanes<N, M> {
        let mut moved = [[0.0; N]; M];
        add_product(&mut moved, &self.matrix, lanes);
        for (row, factor) in moved.iter_mut().zip(self.by_torque) {
            if factor != 0.0 {
                row.iter_mut().zip(torque_lanes).for_each(|(entry, t)| *entry += factor * t);
            }
        }
        for Varying { lane, by_state, by_torque } in &self.varying {
            for i in 0..M {
                let states = by_state.iter().zip(state).map(|(column, x)| column[i] * x);
                moved[i][*lane] += states.sum::<f64>() + by_torque[i] * torque;
            }
        }
        moved
    }
}

/// The derivatives of a number.
fn lanes_of<const N: usize>(number: Dual<N>) -> [f64; N] {
    std::array::from_fn(|lane| number.lane(lane))
}

/// Adds the product of a matrix and the lanes of a vector. Most entries of the matrix are 0.
#[inline]
fn add_product<const N: usize, const M: usize>(
    sum: &mut Lanes<N, M>,
    matrix: &Matrix<f64, M>,
    lanes: &Lanes<N, M>,
) {
    for (column, lanes) in matrix.iter().zip(lanes) {
        for (row, factor) in sum.iter_mut().zip(column) {
            if *factor != 0.0 {
                row.iter_mut().zip(lanes).for_each(|(entry, lane)| *entry += factor * lane);
            }
        }
    }
}

#[inline]
fn add<const N: usize, const M: usize>(sum: &mut Lanes<N, M>, more: &Lanes<N, M>) {
    for (row, more) in sum.iter_mut().zip(more) {
        row.iter_mut().zip(more).for_each(|(entry, more)| *entry += more);
    }
}
