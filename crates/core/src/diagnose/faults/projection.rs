//! How much of what a fit leaves a fault of the measurement would explain.

use nalgebra::{DMatrix, DVector};

use crate::diagnose::residuals::subspace::Subspace;

use super::candidates::{Candidate, Column};

/// Below this share of its length a direction counts as absorbed by the fit.
const ABSORBED: f64 = 1e-6;

/// The directions of a candidate outside of what the fit absorbs.
pub(super) struct Outside {
    columns: Vec<Column>,
    /// Inverse of the information matrix of the candidate's parameters.
    covariance: DMatrix<f64>,
    /// ln det of I + S·Λ·S, with S the prior deviations and Λ the information.
    pub volume: f64,
    positive: bool,
}

impl Outside {
    /// `None` if the fit absorbs a direction of the candidate.
    pub fn of(candidate: &Candidate, fitted: &Subspace) -> Option<Self> {
        let inside: Vec<DVector<f64>> =
            candidate.columns.iter().map(|column| fitted.coordinates(column)).collect();
        let count = candidate.columns.len();
        let information = DMatrix::from_fn(count, count, |i, j| {
            sparse_product(&candidate.columns[i], &candidate.columns[j]) - inside[i].dot(&inside[j])
        });
        let whole = |i: usize| sparse_product(&candidate.columns[i], &candidate.columns[i]);
        let is_seen = |i: usize| information[(i, i)] > ABSORBED * whole(i);
        if !(0..count).all(is_seen) {
            return None;
        }
        let deviations = &candidate.deviations;
        let scaled = DMatrix::from_fn(count, count, |i, j| {
            information[(i, j)] * deviations[i] * deviations[j] + f64::from(u8::from(i == j))
        });
        let volume = scaled.determinant().ln();
        let covariance = information.try_inverse()?;
        let columns = candidate.columns.clone();
        Some(Self { columns, covariance, volume, positive: candidate.positive })
    }

    /// The decrease of Σr² by the best values of the parameters, and these values; `left` are
    /// residuals outside of what the fit absorbs.
    pub fn best(&self, left: &DVector<f64>) -> (f64, DVector<f64>) {
        let slope = DVector::from_iterator(
            self.columns.len(),
            self.columns.iter().map(|column| column.iter().map(|(row, x)| x * left[*row]).sum()),
        );
        let values = &self.covariance * &slope;
        match self.positive && values[0] <= 0.0 {
            true => (0.0, values * 0.0),
            false => (slope.dot(&values), values),
        }
    }

    /// Standard deviations of the parameters, in units of that of the residuals.
    pub fn deviations(&self) -> DVector<f64> {
        self.covariance.diagonal().map(f64::sqrt)
    }
}

fn sparse_product(one: &Column, other: &Column) -> f64 {
    // Columns of one candidate have the same rows, in the same order, or none in common.
    one.iter().zip(other).filter(|(a, b)| a.0 == b.0).map(|(a, b)| a.1 * b.1).sum()
}

/// A column with all its rows.
pub(super) fn dense(column: &Column, rows: usize) -> DVector<f64> {
    let mut dense = DVector::zeros(rows);
    column.iter().for_each(|(row, value)| dense[*row] = *value);
    dense
}
