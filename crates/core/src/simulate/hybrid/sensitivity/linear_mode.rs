//! The equations of one mode with their derivatives: x' = A·x + b·τ + d, and for a lane
//!
//! ```text
//!   δx' = A·δx + δA·x + δb·τ + b·δτ + δd
//! ```
//!
//! Only few lanes change A and b (those of masses, springs and damping), and only those are visited.

use crate::plant::{Dual, Scalar as _};

use super::Lanes;
use crate::simulate::hybrid::affine::{Affine, Matrix, SERIES_TERMS, StepMatrices};
use crate::simulate::hybrid::mechanics::{Mechanics, Mode};
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::signal::piecewise_quintic::Quintic;

/// Number of lanes for which the derivatives of matrices are computed together.
const LANES_AT_ONCE: usize = 4;

/// Derivative of the torque over a step by each lane by which it has one.
pub(super) type TorqueLanes = [(usize, Quintic<f64>)];

/// The equations of one mode and their derivatives by N lanes.
pub(super) struct LinearMode<const N: usize, const M: usize> {
    /// With all derivatives.
    lifted: Affine<Dual<N>, M>,
    /// Without derivatives.
    plain: Affine<f64, M>,
    /// δA and δb of the lanes that have any.
    varying: Vec<Varying<M, 1>>,
    /// δd.
    constant: Lanes<N, M>,
    cached: Option<CachedStep<N, M>>,
}

/// Derivatives by one lane: of a matrix, and of the vectors that multiply K coefficients of the
/// torque.
struct Varying<const M: usize, const K: usize> {
    lane: usize,
    matrix: Matrix<f64, M>,
    by_torque: [Vector<f64, M>; K],
}

impl<const M: usize, const K: usize> Varying<M, K> {
    /// Adds the change that they make to the derivatives by the lane.
    #[inline]
    fn add_to<const N: usize>(
        &self,
        sum: &mut Lanes<N, M>,
        state: &Vector<f64, M>,
        torque: &[f64; K],
    ) {
        for (i, row) in sum.iter_mut().enumerate() {
            let by_state = self.matrix.iter().zip(state).map(|(column, x)| column[i] * x);
            let by_torque = self.by_torque.iter().zip(torque).map(|(gain, power)| gain[i] * power);
            row[self.lane] += by_state.chain(by_torque).sum::<f64>();
        }
    }
}

/// A step of one length: x goes to Φx + Σ τᵢΓᵢ + δ (see [`Affine`]).
struct CachedStep<const N: usize, const M: usize> {
    plain: StepMatrices<f64, M>,
    varying: Vec<Varying<M, 6>>,
    drift: Lanes<N, M>,
}

impl<const N: usize, const M: usize> LinearMode<N, M> {
    pub fn new(mechanics: &Mechanics<Dual<N>>, mode: Mode) -> Self {
        let lifted = Affine::new(mechanics, mode);
        let varying = (0..N).filter_map(|lane| {
            let of = |vector: &Vector<Dual<N>, M>| vector.map(|entry| entry.lane(lane));
            let (matrix, by_torque) = (lifted.matrix.each_ref().map(of), [of(&lifted.by_torque)]);
            let varies = matrix.iter().chain(&by_torque).flatten().any(|entry| *entry != 0.0);
            varies.then_some(Varying { lane, matrix, by_torque })
        });
        Self {
            varying: varying.collect(),
            plain: lifted.map(Dual::value),
            constant: lifted.constant.map(|x| std::array::from_fn(|lane| x.lane(lane))),
            cached: None,
            lifted,
        }
    }

    /// The mode.
    pub fn mode(&self) -> Mode {
        self.plain.mode
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
        if self.cached.as_ref().is_none_or(|cached| cached.plain.length_s != length_s) {
            self.cached = Some(self.cached_step(length_s));
        }
        let Some(cached) = &self.cached else { return *lanes };
        let mut end = cached.drift;
        add_product(&mut end, &cached.plain.propagator, lanes);
        cached.varying.iter().for_each(|varying| varying.add_to(&mut end, start, powers));
        for (lane, powers) in torque {
            for (i, row) in end.iter_mut().enumerate() {
                let gains = cached.plain.gains.iter().zip(powers);
                row[*lane] += gains.map(|(gain, power)| gain[i] * power).sum::<f64>();
            }
        }
        end
    }

    /// Only the lanes that change A or b need the derivatives of the matrices. The others change δ
    /// in proportion to d.
    fn cached_step(&self, length_s: f64) -> CachedStep<N, M> {
        let mut drift = [[0.0; N]; M];
        let mut varying = Vec::with_capacity(self.varying.len());
        for some in self.varying.chunks(LANES_AT_ONCE) {
            let few = self.lifted.map(|x| {
                let of = |i: usize| some.get(i).map_or(0.0, |varying| x.lane(varying.lane));
                Dual::<LANES_AT_ONCE>::with_lanes(x.value(), of)
            });
            let step = few.matrices_of_step(length_s);
            for (i, Varying { lane, .. }) in some.iter().enumerate() {
                let of = |vector: &Vector<Dual<LANES_AT_ONCE>, M>| vector.map(|x| x.lane(i));
                let matrix = step.propagator.each_ref().map(of);
                let by_torque = step.gains.each_ref().map(of);
                varying.push(Varying { lane: *lane, matrix, by_torque });
                drift.iter_mut().zip(of(&step.drift)).for_each(|(row, x)| row[*lane] = x);
            }
        }
        for lane in 0..N {
            let constant = self.constant.each_ref().map(|row| row[lane]);
            let is_varying = self.varying.iter().any(|varying| varying.lane == lane);
            if !is_varying && constant.iter().any(|x| *x != 0.0) {
                let change = self.plain.drift(&constant, length_s);
                drift.iter_mut().zip(change).for_each(|(row, x)| row[lane] = x);
            }
        }
        CachedStep { plain: self.plain.matrices_of_step(length_s), varying, drift }
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
        let (mut state, mut term, mut sum) = (*start, *lanes, *lanes);
        for m in 0..SERIES_TERMS {
            let driving = powers.get(m).copied().unwrap_or(0.0);
            term = self.next_term(m, &state, &term, (driving, &[0.0; N]), torque, length_s);
            add(&mut sum, &term);
            state = self.plain.next_term(m, &state, powers, &self.plain.constant, length_s);
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
        add_product(&mut moved, &self.plain.matrix, lanes);
        for (row, factor) in moved.iter_mut().zip(self.plain.by_torque) {
            if factor != 0.0 {
                row.iter_mut().zip(torque_lanes).for_each(|(entry, t)| *entry += factor * t);
            }
        }
        self.varying.iter().for_each(|varying| varying.add_to(&mut moved, state, &[torque]));
        moved
    }
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
