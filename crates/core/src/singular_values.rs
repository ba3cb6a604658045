//! Singular value decomposition A = U·Σ·Vᵀ by the one-sided Jacobi method (Hestenes 1958,
//! doi:10.1137/0106005).
//!
//! Plane rotations of the columns make them orthogonal to each other; their lengths are then the
//! singular values. The method is slow for large matrices, but those here have few columns, and it
//! is accurate even for small singular values (Demmel and Veselić 1992, doi:10.1137/0613074). The
//! decomposition of `nalgebra` 0.35 is not used, because it returns wrong singular values for some
//! ordinary matrices (<https://github.com/dimforge/nalgebra/issues/1172>).

use nalgebra::{DMatrix, DVector};

/// Two columns count as orthogonal if the cosine of the angle between them is below this.
const ORTHOGONAL: f64 = 4.0 * f64::EPSILON;

/// Most sweeps over all pairs of columns. The method converges quadratically, mostly in five to
/// ten.
const MOST_SWEEPS: usize = 60;

/// The decomposition of a matrix of m rows and n columns, by descending singular values.
#[derive(Debug, Clone)]
pub(crate) struct SingularValues {
    /// m × n. A column whose singular value is 0 is 0, else they are orthonormal.
    pub left: DMatrix<f64>,
    /// n values, of which n − m are 0 if there are more columns than rows.
    pub values: DVector<f64>,
    /// n × n, orthonormal columns.
    pub right: DMatrix<f64>,
}

impl SingularValues {
    /// Decomposes a matrix; its entries must be finite.
    pub fn of(matrix: DMatrix<f64>) -> Self {
        // Of a tall matrix the triangular factor is decomposed.
        let (basis, mut columns) = if matrix.nrows() > 2 * matrix.ncols() {
            let (q, r) = matrix.qr().unpack();
            (Some(q), r)
        } else {
            (None, matrix)
        };
        let count = columns.ncols();
        let rounding = f64::EPSILON * columns.norm();
        let mut right = DMatrix::identity(count, count);
        for _ in 0..MOST_SWEEPS {
            let mut rotated = false;
            for p in 0..count {
                for q in p + 1..count {
                    if let Some(rotation) = orthogonalising(&columns, [p, q], rounding) {
                        rotate(&mut columns, [p, q], rotation);
                        rotate(&mut right, [p, q], rotation);
                        rotated = true;
                    }
                }
            }
            if !rotated {
                break;
            }
        }
        let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
        let (mut left, right) = (columns.select_columns(&order), right.select_columns(&order));
        let values = DVector::from_iterator(count, order.iter().map(|i| lengths[*i]));
        for (mut column, length) in left.column_iter_mut().zip(&values) {
            if *length > 0.0 {
                column.unscale_mut(*length);
            }
        }
        Self { left: basis.map_or(left.clone(), |basis| basis * left), values, right }
    }

    /// Number of singular values above `share` of the largest.
    pub fn rank(&self, share: f64) -> usize {
        let least = share * self.values.max();
        self.values.iter().take_while(|value| **value > least).count()
    }

    /// The shortest solution X of A·X = B in the sense of least squares. Singular values up to
    /// `share` of the largest are taken for 0.
    pub fn solve(&self, b: &DMatrix<f64>, share: f64) -> DMatrix<f64> {
        let rank = self.rank(share);
        let mut along = self.left.columns(0, rank).tr_mul(b);
        for (mut row, value) in along.row_iter_mut().zip(&self.values) {
            row.unscale_mut(*value);
        }
        self.right.columns(0, rank) * along
    }
}

/// Cosine and sine of the rotation that makes columns `p` and `q` orthogonal; `None` if they are so
/// already, or if one is no longer than `rounding`.
fn orthogonalising(columns: &DMatrix<f64>, [p, q]: [usize; 2], rounding: f64) -> Option<[f64; 2]> {
    let (first, second) = (columns.column(p), columns.column(q));
    let (lengths, product) = ([first.norm(), second.norm()], first.dot(&second));
    let is_orthogonal = product.abs() <= ORTHOGONAL * lengths[0] * lengths[1];
    if is_orthogonal || lengths[0].min(lengths[1]) <= rounding {
        return None;
    }
    // Of the two angles that make them orthogonal, the smaller one (Rutishauser 1966,
    // doi:10.1007/BF02165223).
    let half_ratio = (lengths[1] - lengths[0]) * (lengths[1] + lengths[0]) / (2.0 * product);
    let tangent = half_ratio.signum() / (half_ratio.abs() + half_ratio.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    Some([cosine, cosine * tangent])
}

/// Rotates two columns.
fn rotate(matrix: &mut DMatrix<f64>, [p, q]: [usize; 2], [cosine, sine]: [f64; 2]) {
    for row in 0..matrix.nrows() {
        let (first, second) = (matrix[(row, p)], matrix[(row, q)]);
        matrix[(row, p)] = cosine * first - sine * second;
        matrix[(row, q)] = sine * first + cosine * second;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks A = U·Σ·Vᵀ and that U (where the singular values are not 0) and V are orthonormal.
    fn check(matrix: &DMatrix<f64>) -> SingularValues {
        let svd = SingularValues::of(matrix.clone());
        let scale = matrix.norm().max(f64::MIN_POSITIVE);
        let again = &svd.left * DMatrix::from_diagonal(&svd.values) * svd.right.transpose();
        assert!((again - matrix).norm() < 1e-14 * scale, "{matrix}");
        assert!(svd.values.as_slice().is_sorted_by(|a, b| a >= b));
        for basis in [svd.left.columns(0, svd.rank(1e-14)).into_owned(), svd.right.clone()] {
            let error = basis.tr_mul(&basis) - DMatrix::identity(basis.ncols(), basis.ncols());
            assert!(error.norm() < 1e-13, "{matrix} {error}");
        }
        svd
    }

    // The second singular value of the first is 2.396 in nalgebra 0.35. The second is from its issue
    // 1172.
    #[test]
    fn matrices_on_which_nalgebra_fails_are_decomposed() {
        let columns = [
            [-1.0013110404498944, 1.0566862914931163, 58.60011572458653],
            [-0.0010738675031305052, -0.13447287246281347, 49.22411464403722],
            [1.1048989070711839, 45.79516598976001, 1215.332612468559],
        ];
        let found = check(&DMatrix::from_fn(3, 3, |row, column| columns[column][row]));
        assert!((found.values[1] - 2.3726923).abs() < 1e-6, "{}", found.values);
        let ones = check(&DMatrix::repeat(3, 5, 1.0));
        assert!((ones.values[0] - 15.0_f64.sqrt()).abs() < 1e-14, "{}", ones.values);
        assert_eq!(ones.rank(1e-14), 1);
    }

    #[test]
    fn matrices_of_any_shape_and_rank_are_decomposed() {
        for (rows, columns) in [(1, 1), (1, 4), (4, 1), (3, 3), (7, 5), (40, 6)] {
            let entry = |row: usize, column: usize| ((row * 7 + column * 3 + 1) as f64).sin();
            check(&DMatrix::from_fn(rows, columns, entry));
            check(&DMatrix::from_fn(rows, columns, |row, column| {
                entry(row, column) * 1e-6_f64.powi(column as i32)
            }));
            check(&DMatrix::zeros(rows, columns));
        }
    }

    // Columns of sizes 1, 1e-5 and 1e-10.
    #[test]
    fn small_singular_values_are_accurate_too() {
        let scaled =
            DMatrix::from_row_slice(3, 3, &[1.0, 1e-5, 0.0, 0.0, 1e-5, 1e-10, 0.0, 0.0, 1e-10]);
        // The determinant is the product of the singular values.
        let values = SingularValues::of(scaled).values;
        assert!((values.product() / 1e-15 - 1.0).abs() < 1e-14, "{values}");
    }

    #[test]
    fn of_many_solutions_the_shortest_is_returned() {
        let svd = SingularValues::of(DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]));
        let found = svd.solve(&DMatrix::from_column_slice(2, 1, &[2.0, 4.0]), 1e-12);
        assert!((found[0] - 1.5).abs() < 1e-14 && (found[1] - 1.5).abs() < 1e-14, "{found}");
    }
}
