//! Principal components of the standardised features (K. Pearson 1901,
//! doi:10.1080/14786440109462720).
//!
//! Responses at neighbouring frequencies and magnitudes vary together, so that some twenty directions
//! hold nearly all that ninety features say, and a network of these trains four times as fast.

use nalgebra::{DMatrix, SymmetricEigen};

/// Share of the features' mean square that may be lost (tuned).
const LOST_SHARE: f64 = 1e-3;

/// The directions along which samples vary most.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Components {
    /// Orthonormal rows, of the length of a sample, the one of the largest variance first.
    directions: Vec<Vec<f64>>,
}

impl Components {
    /// The fewest directions that lose no more than [`LOST_SHARE`] of the mean square; at least one.
    pub(super) fn of(samples: &[&[f64]]) -> Self {
        let length = samples.first().map_or(0, |sample| sample.len());
        let rows = DMatrix::from_fn(samples.len(), length, |i, j| samples[i][j]);
        let eigen = SymmetricEigen::new(rows.tr_mul(&rows));
        let mut order: Vec<usize> = (0..length).collect();
        order.sort_by(|i, j| eigen.eigenvalues[*j].total_cmp(&eigen.eigenvalues[*i]));
        let mut lost: f64 = eigen.eigenvalues.iter().sum();
        let most = LOST_SHARE * lost;
        let kept = order.iter().enumerate().take_while(|(i, index)| {
            let needed = *i == 0 || lost > most;
            lost -= eigen.eigenvalues[**index];
            needed
        });
        let direction = |index: &usize| eigen.eigenvectors.column(*index).iter().copied().collect();
        Self { directions: kept.map(|(_, index)| direction(index)).collect() }
    }

    /// The coordinates of a sample along the directions.
    pub(super) fn project(&self, sample: &[f64]) -> Vec<f64> {
        let along = |direction: &Vec<f64>| direction.iter().zip(sample).map(|(d, x)| d * x).sum();
        self.directions.iter().map(along).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_plane_have_two_components() {
        let sample = |i: usize| {
            let (x, y) = ((i as f64).sin(), (0.3 * i as f64).cos());
            vec![x + y, x - y, 2.0 * x, 0.0]
        };
        let samples: Vec<Vec<f64>> = (0..50).map(sample).collect();
        let rows: Vec<&[f64]> = samples.iter().map(Vec::as_slice).collect();
        let components = Components::of(&rows);
        assert_eq!(components.directions.len(), 2);
        for sample in &samples {
            let along = components.project(sample);
            let size = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
            // Rounding of sums of four terms.
            assert!((size(&along) - size(sample)).abs() < 1e-12);
        }
    }

    #[test]
    fn constant_samples_have_one_component() {
        let components = Components::of(&[&[0.0, 0.0], &[0.0, 0.0]]);
        assert_eq!(components.project(&[1.0, 0.0]).len(), 1);
    }
}
