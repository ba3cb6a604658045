//! Orthogonal projection on a column space, and on its orthogonal complement.

use nalgebra::{DMatrix, DVector, DVectorView};

use crate::singular_values::SingularValues;

/// Directions with a singular value below this share of the largest are rounding errors.
const RANK_TOLERANCE: f64 = 1e-8;

/// A subspace, by an orthonormal basis: one column for each direction.
#[derive(Debug, Clone)]
pub(crate) struct Subspace {
    basis: DMatrix<f64>,
}

impl Subspace {
    /// The span of the columns.
    pub fn of(columns: &DMatrix<f64>) -> Self {
        // Give all columns the length 1, because the tolerance is relative to the largest.
        let sized: Vec<DVector<f64>> = columns
            .column_iter()
            .filter(|column| column.norm() > 0.0 && column.norm().is_finite())
            .map(|column| column / column.norm())
            .collect();
        if sized.is_empty() {
            return Self { basis: DMatrix::zeros(columns.nrows(), 0) };
        }
        let svd = SingularValues::of(DMatrix::from_columns(&sized));
        Self { basis: svd.left.columns(0, svd.rank(RANK_TOLERANCE)).into_owned() }
    }

    /// The part of the span of the columns that is orthogonal to `other`.
    pub fn beyond(columns: &DMatrix<f64>, other: &Subspace) -> Self {
        let mut left = columns.clone();
        for mut column in left.column_iter_mut() {
            let before = column.norm();
            let kept = other.complement(&column.clone_owned());
            // If nearly nothing is left, the column lies in the other space.
            let rounding = kept.norm() <= RANK_TOLERANCE * before;
            column.copy_from(&if rounding { DVector::zeros(kept.len()) } else { kept });
        }
        Self::of(&left)
    }

    /// Dimension.
    pub fn dimension(&self) -> usize {
        self.basis.ncols()
    }

    /// The span where each coordinate is multiplied by its own factor.
    pub fn stretched(&self, factors: &DVector<f64>) -> Self {
        let mut basis = self.basis.clone();
        basis.column_iter_mut().for_each(|mut column| column.component_mul_assign(factors));
        Self::of(&basis)
    }

    /// The part of a vector inside the subspace.
    pub fn project(&self, vector: &DVector<f64>) -> DVector<f64> {
        &self.basis * self.basis.tr_mul(vector)
    }

    /// The part of a vector orthogonal to the subspace.
    pub fn complement(&self, vector: &DVector<f64>) -> DVector<f64> {
        vector - self.project(vector)
    }

    /// The coordinates, in the basis of the subspace, of the part inside it of a vector of few
    /// entries, each with its row.
    pub fn coordinates(&self, entries: &[(usize, f64)]) -> DVector<f64> {
        let mut coordinates = DVector::zeros(self.dimension());
        for (row, value) in entries {
            coordinates
                .iter_mut()
                .zip(self.basis.row(*row).iter())
                .for_each(|(c, b)| *c += b * value);
        }
        coordinates
    }

    /// The span of this subspace and some columns.
    pub fn with(&self, columns: &DMatrix<f64>) -> Self {
        let more = Self::beyond(columns, self);
        let joined = self.basis.column_iter().chain(more.basis.column_iter());
        let joined: Vec<_> = joined.map(|column| column.into_owned()).collect();
        match joined.is_empty() {
            true => self.clone(),
            false => Self { basis: DMatrix::from_columns(&joined) },
        }
    }

    /// The parts of columns orthogonal to the subspace.
    pub fn complements(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        columns - &self.basis * self.basis.tr_mul(columns)
    }

    /// Squared length of the part of a vector inside the subspace.
    pub fn energy(&self, vector: &DVector<f64>) -> f64 {
        self.basis.tr_mul(vector).norm_squared()
    }

    /// The largest energy of each column of a matrix in any of some subspaces. One product of
    /// matrices is quicker than many with vectors.
    pub fn largest_energies(spaces: &[Self], columns: &DMatrix<f64>) -> Vec<f64> {
        let bases: Vec<_> = spaces.iter().flat_map(|space| space.basis.column_iter()).collect();
        if bases.is_empty() {
            return vec![0.0; columns.ncols()];
        }
        let inside = DMatrix::from_columns(&bases).transpose() * columns;
        let largest = |column: DVectorView<'_, f64>| {
            let mut squares = column.iter().map(|along| along * along);
            let energies =
                spaces.iter().map(|space| squares.by_ref().take(space.dimension()).sum());
            energies.fold(0.0, f64::max)
        };
        inside.column_iter().map(largest).collect()
    }

    /// The leverages: the squared length of the part of each unit vector inside the subspace.
    pub fn leverages(&self) -> Vec<f64> {
        self.basis.row_iter().map(|row| row.norm_squared()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_column_adds_no_dimension() {
        let columns = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 0.0, 0.0, 1e6, 1.0, 2.0, 0.0]);
        let space = Subspace::of(&columns);
        assert_eq!(space.dimension(), 2);
        let leverages = space.leverages();
        // Unit vectors 1 and 3 lie half inside, 2 wholly.
        for (found, wanted) in leverages.iter().zip([0.5, 1.0, 0.5]) {
            assert!((found - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_beyond_is_orthogonal_and_may_be_nothing() {
        let first = Subspace::of(&DMatrix::from_row_slice(3, 1, &[1.0, 1.0, 0.0]));
        let columns = DMatrix::from_row_slice(3, 2, &[2.0, 1.0, 2.0, 0.0, 0.0, 0.0]);
        let beyond = Subspace::beyond(&columns, &first);
        assert_eq!(beyond.dimension(), 1);
        let probe = DVector::from_vec(vec![1.0, -1.0, 5.0]);
        assert!((beyond.energy(&probe) - 2.0).abs() < 1e-12);
        assert!((first.complement(&probe) - &probe).norm() < 1e-12);
    }

    #[test]
    fn the_largest_energy_of_each_column_is_that_in_the_subspace_that_holds_most_of_it() {
        let plane = Subspace::of(&DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
        let line = Subspace::of(&DMatrix::from_row_slice(3, 1, &[0.0, 0.0, 1.0]));
        let columns = DMatrix::from_row_slice(3, 2, &[3.0, 1.0, 4.0, 0.0, 1.0, -2.0]);
        let found = Subspace::largest_energies(&[plane, line], &columns);
        assert!((found[0] - 25.0).abs() < 1e-12 && (found[1] - 4.0).abs() < 1e-12, "{found:?}");
        assert_eq!(Subspace::largest_energies(&[], &columns), [0.0, 0.0]);
    }
}
