//! The search for the initial state: least squares over the first stretch of a motion.

use nalgebra::{DMatrix, DVector};

use crate::identify::levenberg_marquardt::{
    FIRST_DAMPING, LeastSquares, Linearisation, Patience, minimise,
};
use crate::identify::transient_prediction::Model;
use crate::simulate::{InitialState, NoResponse, Quantity, Unknown};

/// Standard deviation of the prior of an unknown, in units of [`Unknown::size`]: that of a uniform
/// distribution over ±1, 1/√3.
const PRIOR_STD: f64 = 0.577_350_269_189_625_8;

/// When the least-squares fit ends (tuned): a beginning is not known more accurately than this.
const PATIENCE: Patience = Patience {
    steps: 12,
    evaluations: u64::MAX,
    cost_tolerance: 1e-6,
    negligible: 0.0,
    damping: FIRST_DAMPING,
    linear_within: 0.0,
};

/// Step of an unknown, in units of its size, for finite differences.
const DIFFERENCE: f64 = 1e-5;

/// Initial positions that are tried if the position acts on the motion (tuned).
const POSITIONS_TRIED: usize = 12;

/// The best of these, from which least squares start (tuned).
const POSITIONS_REFINED: usize = 3;

/// Least squares over the first stretch. A point holds, for each unknown, its distance from rest in
/// units of [`Unknown::size`].
pub(super) struct Search<'a> {
    pub(super) model: &'a Model<'a>,
    pub(super) rest: InitialState,
    pub(super) unknowns: &'a [Unknown],
    pub(super) measured: Vec<f64>,
    /// Rms of the response.
    pub(super) size: f64,
    /// σ²·τ, divided by the square of `size`.
    pub(super) error: f64,
}

impl Search<'_> {
    pub(super) fn initial(&self, point: &[f64]) -> InitialState {
        let mut initial = self.rest;
        for (unknown, x) in self.unknowns.iter().zip(point) {
            // An unknown at rest is not set: the simulation has its own rest value. For a torque
            // that is the actuator's output under the first input, after any effects ahead of the
            // actuator.
            if *x != 0.0 || unknown.quantity == Quantity::Velocity {
                initial.set(unknown.quantity, unknown.at_rest + x * unknown.size);
            }
        }
        initial
    }

    /// Residuals of the stretch, divided by `size`, then those of the prior.
    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResponse> {
        let count = self.measured.len();
        let simulated = self.model.response(count, &self.initial(point))?;
        let left = self.model.compared(&simulated);
        let left = left.iter().zip(&self.measured).map(|(s, m)| (m - s) / self.size);
        let prior_weight = self.error.sqrt() / PRIOR_STD;
        let all: Vec<f64> = left.chain(point.iter().map(|x| prior_weight * x)).collect();
        Ok(DVector::from_vec(all))
    }

    /// The sum that is to be least.
    pub(super) fn sum(&self, point: &[f64]) -> Result<f64, NoResponse> {
        Ok(self.residuals(point)?.norm_squared())
    }

    /// Starting points: the velocity of the first samples, with the initial positions that suit it
    /// best.
    pub(super) fn starts(&self) -> Result<Vec<Vec<f64>>, NoResponse> {
        let shown = self.model.first_velocity(self.measured.len());
        let velocity = shown.map_or(0.0, |shown| shown.value);
        let mut start = vec![0.0; self.unknowns.len()];
        for (x, unknown) in start.iter_mut().zip(self.unknowns) {
            if unknown.quantity == Quantity::Velocity {
                *x = velocity / unknown.size;
            }
        }
        let position = self.unknowns.iter().position(|u| u.quantity == Quantity::Position);
        let Some(position) = position else { return Ok(vec![start]) };
        let mut tried = Vec::new();
        for step in 0..POSITIONS_TRIED {
            let mut point = start.clone();
            point[position] = 2.0 * (step as f64 + 0.5) / POSITIONS_TRIED as f64 - 1.0;
            tried.push((self.sum(&point)?, point));
        }
        tried.push((self.sum(&start)?, start));
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(tried.into_iter().take(POSITIONS_REFINED).map(|(_, point)| point).collect())
    }

    /// The least sum, and its point, found by least squares from `starts`; rest is a candidate too.
    pub(super) fn best(&self, starts: Vec<Vec<f64>>) -> Result<(f64, Vec<f64>), NoResponse> {
        let still = vec![0.0; self.unknowns.len()];
        let mut best = (self.sum(&still)?, still);
        for start in starts {
            let found = minimise(self, &start, PATIENCE, &mut |_, _, _| ());
            if found.cost < best.0 {
                best = (found.cost, found.point);
            }
        }
        Ok(best)
    }
}

impl LeastSquares for Search<'_> {
    type Error = NoResponse;

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResponse> {
        Search::residuals(self, point)
    }

    /// Derivatives by differences.
    fn linearise(&self, point: &[f64]) -> Result<Linearisation, NoResponse> {
        let residuals = self.residuals(point)?;
        let mut jacobian = DMatrix::zeros(residuals.len(), point.len());
        for column in 0..point.len() {
            let mut moved = point.to_vec();
            moved[column] += DIFFERENCE;
            let change = (self.residuals(&moved)? - &residuals) / DIFFERENCE;
            jacobian.set_column(column, &change);
        }
        Ok(Linearisation { residuals, jacobian })
    }
}
