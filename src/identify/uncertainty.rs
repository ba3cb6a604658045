//! Standard deviations, correlations, and what the data does not determine.

use nalgebra::DMatrix;

use super::objective::Linearisation;
use super::parameters::Coordinates;

/// A direction whose effect on the response is this much smaller than that of
/// the strongest one is lost in rounding: the data cannot see it.
const RANK_TOLERANCE: f64 = 1e-9;

/// A logarithm (or a level in units of the largest input) known no better than
/// this is not identified: the interval would span more than a factor of 50.
const LARGEST_STD: f64 = 1.0;

/// Covariance of the coordinates, and which of them the data determines.
#[derive(Debug, Clone)]
pub(super) struct Uncertainty {
    /// Covariance; rows of what is held or unseen are 0.
    pub covariance: DMatrix<f64>,
    /// Orthonormal directions the data does not see, as columns.
    unseen: DMatrix<f64>,
}

impl Uncertainty {
    /// From the linearisation at the refined point; coordinates `held` at a
    /// bound are taken as known, the others' deviations are times `scale`.
    pub fn new(here: &Linearisation, held: &[bool], scale: f64) -> Self {
        let all = held.len();
        let free: Vec<usize> = (0..all).filter(|i| !held[*i]).collect();
        let mut covariance = DMatrix::zeros(all, all);
        let mut unseen = Vec::new();
        let slim = here.jacobian.select_columns(&free);
        let finite = slim.iter().all(|value| value.is_finite());
        if !free.is_empty() && finite {
            let svd = slim.svd(false, true);
            let directions = svd.v_t.expect("requested");
            let strongest = svd.singular_values.max();
            for (s, singular) in svd.singular_values.iter().enumerate() {
                if *singular <= RANK_TOLERANCE * strongest {
                    let mut direction = vec![0.0; all];
                    for (f, i) in free.iter().enumerate() {
                        direction[*i] = directions[(s, f)];
                    }
                    unseen.push(direction);
                    continue;
                }
                let variance = (scale / singular).powi(2);
                for (f, i) in free.iter().enumerate() {
                    for (g, j) in free.iter().enumerate() {
                        covariance[(*i, *j)] += variance * directions[(s, f)] * directions[(s, g)];
                    }
                }
            }
        }
        let unseen = DMatrix::from_fn(all, unseen.len(), |i, d| unseen[d][i]);
        Self { covariance, unseen }
    }

    /// Standard deviation of a linear combination of coordinates; `None` where
    /// the data does not determine it.
    pub fn std(&self, combination: &[f64]) -> Option<f64> {
        let row = nalgebra::RowDVector::from_row_slice(combination);
        let size = row.norm();
        let lost = (&row * &self.unseen).norm() > 1e-3 * size;
        let std = (&row * &self.covariance * row.transpose())[(0, 0)].max(0.0).sqrt();
        (!lost && std.is_finite() && std <= LARGEST_STD).then_some(std)
    }

    /// Correlation matrix of the coordinates in `which`.
    pub fn correlations(&self, which: &[usize]) -> Vec<Vec<f64>> {
        let c = &self.covariance;
        let of = |i: usize, j: usize| match c[(i, i)] * c[(j, j)] {
            product if i == j || product <= 0.0 => f64::from(u8::from(i == j)),
            product => (c[(i, j)] / product.sqrt()).clamp(-1.0, 1.0),
        };
        which.iter().map(|i| which.iter().map(|j| of(*i, *j)).collect()).collect()
    }
}

/// The combination that is one coordinate alone.
pub(super) fn unit(coordinates: &Coordinates, i: usize) -> Vec<f64> {
    (0..coordinates.len()).map(|j| f64::from(u8::from(i == j))).collect()
}
