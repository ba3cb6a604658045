//! How much of what a fit leaves a fault of the measurement would explain.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::diagnose::residuals::subspace::Subspace;

use super::candidates::{Candidate, Column};

/// Below this share of its length a direction counts as absorbed by the fit.
const ABSORBED: f64 = 1e-6;

/// Least decrease of χ² by a fault of one experiment in rows other than that which shows most.
/// Below, it is that row which is wrong. Three standard deviations.
const LEAST_SHARED: f64 = 9.0;

/// The directions of a candidate outside of what the fit absorbs.
pub(super) struct Outside {
    columns: Vec<Column>,
    /// Inverse of the information matrix of the candidate's parameters.
    covariance: DMatrix<f64>,
    /// ln(1 + s²·λ), with s the prior deviation and λ the information; `None` for a row.
    volume: Option<f64>,
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
        let one_size = |deviation: f64| (1.0 + deviation.powi(2) * information[(0, 0)]).ln();
        let volume = candidate.deviation.map(one_size);
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

    /// What the volume of the parameters costs, −2 ln, where Σr² decreases by `gain`. A row may be off
    /// by anything: its prior is as wide as what is found.
    pub fn volume(&self, gain: f64) -> f64 {
        self.volume.unwrap_or_else(|| self.columns.len() as f64 * gain.max(0.0).ln_1p())
    }

    /// Whether more than the row that shows most speaks for a gain or a phase that several rows
    /// share; `left` as in [`Self::best`].
    pub fn is_shared(&self, left: &DVector<f64>, rows_of_one: &dyn Fn(usize) -> usize) -> bool {
        let mut by_cell: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for (row, value) in self.columns.iter().flatten() {
            let sums = by_cell.entry(rows_of_one(*row)).or_default();
            sums[0] += value * left[*row];
            sums[1] += value * value;
        }
        let whole = by_cell.values().fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        let gain =
            |[slope, information]: [f64; 2]| slope.powi(2) / information.max(f64::MIN_POSITIVE);
        let most = by_cell.values().max_by(|a, b| a[0].abs().total_cmp(&b[0].abs()));
        let rest = most.map_or(whole, |most| [whole[0] - most[0], whole[1] - most[1]]);
        rest[0] * whole[0] > 0.0 && gain(rest) > LEAST_SHARED
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
