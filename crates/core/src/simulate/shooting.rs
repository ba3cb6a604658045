//! Single shooting: Newton's method for the state at the beginning of the period, and the derivatives
//! of the periodic motion by the implicit function theorem.

use nalgebra::{DMatrix, DVector};

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Dual, Scalar};

use super::signal::complex_dual::ComplexDual;

/// Derivatives of harmonics by `parameters` lanes, when the unknowns of the
/// return map ride in the lanes behind them.
///
/// `residuals` are what must vanish, such as the state after a period less the
/// state before it; where the unknowns do not move them (an axis held by
/// friction), they stay.
pub(super) fn differentiate<S: Scalar>(
    harmonics: &[ComplexDual<S>],
    residuals: &[S],
    parameters: usize,
) -> Vec<Vec<Complex>> {
    let unknowns = residuals.len();
    let by_unknown = DMatrix::from_fn(unknowns, unknowns, |r, c| residuals[r].lane(parameters + c));
    let by_parameter = DMatrix::from_fn(unknowns, parameters, |r, p| -residuals[r].lane(p));
    let moves = solve(&by_unknown, &by_parameter);
    (0..parameters)
        .map(|p| {
            let along = |harmonic: &ComplexDual<S>| {
                let moved = (0..unknowns).map(|u| harmonic.lane(parameters + u) * moves[(u, p)]);
                harmonic.lane(p) + moved.sum::<Complex>()
            };
            harmonics.iter().map(along).collect()
        })
        .collect()
}

/// Newton's step from residuals and their derivatives by the unknowns, which
/// ride in the lanes behind `parameters`.
pub(super) fn newton_step<S: Scalar>(residuals: &[S], parameters: usize) -> DVector<f64> {
    let unknowns = residuals.len();
    let jacobian = DMatrix::from_fn(unknowns, unknowns, |r, c| residuals[r].lane(parameters + c));
    let target = DMatrix::from_fn(unknowns, 1, |r, _| -residuals[r].value());
    solve(&jacobian, &target).column(0).into_owned()
}

/// Takes harmonics along a small step of the unknowns, which ride in the lanes
/// behind `parameters`.
pub(super) fn correct<S: Scalar>(
    harmonics: &mut [ComplexDual<S>],
    step: &[f64],
    parameters: usize,
) {
    for harmonic in harmonics {
        let moved: Complex =
            step.iter().enumerate().map(|(u, by)| harmonic.lane(parameters + u) * by).sum();
        *harmonic = ComplexDual { re: harmonic.re + moved.re, im: harmonic.im + moved.im };
    }
}

/// Lanes `first` … `first + count` of an axis as the first of N.
pub(super) fn narrowed<const N: usize>(
    axis: &Axis<Wide>,
    first: usize,
    count: usize,
) -> Axis<Dual<N>> {
    axis.map(|x| {
        let lane = |lane: usize| if lane < count { x.lane(first + lane) } else { 0.0 };
        Dual::with_lanes(x.value(), lane)
    })
}

/// Least squares where a direction does not matter.
fn solve(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.nrows() == 1 {
        let pivot = matrix[(0, 0)];
        return right.map(|value| if pivot == 0.0 { 0.0 } else { value / pivot });
    }
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return DMatrix::repeat(matrix.ncols(), right.ncols(), f64::NAN);
    }
    let svd = matrix.clone().svd(true, true);
    let largest = svd.singular_values.max();
    svd.solve(right, 1e-12 * largest)
        .unwrap_or_else(|_| DMatrix::zeros(matrix.ncols(), right.ncols()))
}
