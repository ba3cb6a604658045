//! Linear least squares that tolerates unknowns which the data does not determine.

use nalgebra::{DMatrix, DVector};

use crate::singular_values::SingularValues;

/// Singular values below this share of the largest are taken for rounding, and the solution has no
/// component along their directions.
const RANK_TOLERANCE: f64 = 1e-12;

/// The rows of a least-squares problem, decomposed once for any number of right-hand sides.
pub(super) struct Decomposed(SingularValues);

impl Decomposed {
    /// `None` if an entry is not finite.
    pub fn of(rows: DMatrix<f64>) -> Option<Self> {
        is_finite(rows.as_slice()).then(|| Self(SingularValues::of(rows)))
    }

    /// For each right-hand side the shortest x that minimises |rows·x − right|, by singular value
    /// decomposition. `None` if an entry or a solution is not finite.
    pub fn solve(&self, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let solutions = is_finite(right.as_slice()).then(|| self.0.solve(right, RANK_TOLERANCE))?;
        is_finite(solutions.as_slice()).then_some(solutions)
    }
}

/// The solution for a single right-hand side: see [`Decomposed::solve`].
pub(super) fn solve(rows: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let right = DMatrix::from_column_slice(right.len(), 1, right.as_slice());
    Some(Decomposed::of(rows)?.solve(&right)?.column(0).into_owned())
}

fn is_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_are_not_finite_have_no_solution() {
        let right = DVector::from_vec(vec![1.0, 2.0]);
        for entry in [f64::NAN, f64::INFINITY] {
            let rows = DMatrix::from_row_slice(2, 1, &[1.0, entry]);
            assert_eq!(solve(rows, &right), None);
        }
    }

    // Only the sum of both unknowns is determined. The shortest solution divides it equally.
    #[test]
    fn of_many_solutions_the_shortest_is_returned() {
        let rows = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]);
        let found = solve(rows, &DVector::from_vec(vec![2.0, 2.0])).unwrap();
        assert!((found[0] - 1.0).abs() < 1e-12 && (found[1] - 1.0).abs() < 1e-12);
    }
}
