//! Noise that is alike in several data of an experiment.
//!
//! A residual r in units of its standard deviations has the correlation matrix R = QΛQᵀ, and R^(−1/2)·r
//! has none. Of the eigenvalues only those above 1 count: along their directions the noise is larger than
//! the standard deviations say. Along the others it is smaller, and nothing is made of that.

use nalgebra::DMatrix;

use super::direction::Direction;
use super::problem::{Prepared, Problem, Target};

/// Eigenvalues up to this change a standard deviation by less than a twentieth.
const LEAST_EIGENVALUE: f64 = 1.1;

/// A real datum of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Row {
    /// Harmonic.
    pub order: usize,
    /// Whether it is the imaginary part.
    pub imaginary: bool,
}

impl Row {
    /// The one or two of a target.
    pub fn of(target: &Target) -> impl Iterator<Item = Self> {
        let order = target.order;
        let parts: &[bool] = if target.real { &[false] } else { &[false, true] };
        parts.iter().map(move |imaginary| Self { order, imaginary: *imaginary })
    }
}

/// How the noise of some data of an experiment is correlated.
#[derive(Debug, Clone)]
pub(super) struct Correlation {
    /// The data, by harmonic.
    pub rows: Vec<Row>,
    /// Their correlation matrix.
    pub matrix: DMatrix<f64>,
}

/// The directions along which the noise of a problem is larger than its standard deviations say. An
/// experiment of which something is estimated with every model has none: its directions would have to
/// be orthogonal to these.
pub(super) fn directions(
    problem: &Problem,
    correlations: &[Option<Correlation>],
) -> Vec<Direction> {
    let mut first = 0;
    let mut directions = Vec::new();
    for (e, experiment) in problem.experiments.iter().enumerate() {
        let known = !experiment.unknown_jump && experiment.unknown_input.columns.is_empty();
        if let Some(correlation) = correlations.get(e).and_then(Option::as_ref).filter(|_| known) {
            let own = correlation.larger(experiment).into_iter();
            directions.extend(own.map(|(rows, kept)| Direction {
                experiment: e,
                first,
                rows,
                kept,
            }));
        }
        first += experiment.targets.iter().flat_map(Row::of).count();
    }
    directions
}

impl Correlation {
    /// The directions in the rows of an experiment with these or some of these data, and what is kept of
    /// a residual along each.
    fn larger(&self, experiment: &Prepared) -> Vec<(Vec<f64>, f64)> {
        let place = |row: Row| self.rows.iter().position(|own| *own == row);
        let rows = experiment.targets.iter().flat_map(Row::of);
        let places: Vec<usize> = rows.map_while(place).collect();
        let size = places.len();
        if size == 0 {
            return Vec::new();
        }
        let matrix = DMatrix::from_fn(size, size, |i, j| self.matrix[(places[i], places[j])]);
        let eigen = matrix.symmetric_eigen();
        let larger = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let larger = larger.filter(|(value, _)| **value > LEAST_EIGENVALUE);
        larger.map(|(value, rows)| (rows.iter().copied().collect(), value.sqrt().recip())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis, multisine};

    /// Correlations of 0.8 between neighbouring lines' real parts.
    fn correlation(highest: usize) -> Correlation {
        let parts = |order| [false, true].map(|imaginary| Row { order, imaginary });
        let mean = Row { order: 0, imaginary: false };
        let rows: Vec<Row> = std::iter::once(mean).chain((1..=highest).flat_map(parts)).collect();
        let of = |a: Row, b: Row| match (a.imaginary || b.imaginary, a.order.abs_diff(b.order)) {
            _ if a == b => 1.0,
            (false, distance) => 0.8_f64.powi(distance as i32),
            (true, _) => 0.0,
        };
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| of(rows[i], rows[j]));
        Correlation { rows, matrix }
    }

    #[test]
    fn along_every_direction_of_larger_noise_a_residual_counts_by_its_size() {
        let mut problem = Problem::new(&multisine(&axis(ACTUATORS[0]))).unwrap();
        let correlation = correlation(10);
        let found = directions(&problem, &[Some(correlation.clone())]);
        // An autoregression of 11 steps with 0.8 has two eigenvalues above 1.1.
        assert_eq!(found.len(), 2);
        for direction in &found {
            let rows = nalgebra::DVector::from_column_slice(&direction.rows);
            let variance = rows.dot(&(&correlation.matrix * &rows));
            assert!((direction.kept - variance.sqrt().recip()).abs() < 1e-12);
            assert!(variance > LEAST_EIGENVALUE, "{variance}");
        }
        // Every second line is left: their correlation is that of the whole.
        problem.experiments[0].targets.retain(|target| target.order.is_multiple_of(2));
        let fewer = directions(&problem, &[Some(correlation)]);
        let largest = fewer.iter().map(|direction| direction.kept.powi(-2)).fold(0.0, f64::max);
        // The mean, and the lines 2 to 10.
        let own = DMatrix::from_fn(6, 6, |i, j| 0.64_f64.powi((i as i32 - j as i32).abs()));
        assert!((largest - own.symmetric_eigen().eigenvalues.max()).abs() < 1e-12, "{largest}");
    }

    #[test]
    fn an_experiment_of_which_something_is_estimated_has_none() {
        let mut problem = Problem::new(&multisine(&axis(ACTUATORS[0]))).unwrap();
        problem.experiments[0].unknown_jump = true;
        assert!(directions(&problem, &[Some(correlation(10))]).is_empty());
    }
}
