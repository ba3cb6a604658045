//! Single shooting: Newton's method for the state at the beginning of the period, and derivatives
//! of the periodic motion by the implicit function theorem.
//!
//! Results of the simulation are dual numbers. The first `parameters` lanes hold the derivatives by
//! the parameters, the lanes after them those by the unknowns of the return map (the state at the
//! beginning of the period).

use nalgebra::{DMatrix, DVector};

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Dual, Scalar};
use crate::singular_values::SingularValues;

use super::signal::complex_dual::ComplexDual;

/// Derivatives of the harmonics of a periodic motion by the parameters, one row for each.
///
/// `residuals` must vanish for the motion to be periodic: the state after a period minus the state
/// before it. An unknown that does not affect them (an axis held by friction) stays constant.
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

/// The Newton step of the unknowns that makes the linearised residuals zero.
pub(super) fn newton_step<S: Scalar>(residuals: &[S], parameters: usize) -> DVector<f64> {
    let unknowns = residuals.len();
    let jacobian = DMatrix::from_fn(unknowns, unknowns, |r, c| residuals[r].lane(parameters + c));
    let target = DMatrix::from_fn(unknowns, 1, |r, _| -residuals[r].value());
    solve(&jacobian, &target).column(0).into_owned()
}

/// Corrects the harmonics to first order for a small step of the unknowns.
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

/// The axis in dual numbers of N lanes, the first `count` of which are the lanes from `first` on.
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

/// Solves a linear system. If the matrix is singular, because an unknown has no effect, the result
/// is the least-squares solution of minimum norm; if it is not finite, the result is NaN.
fn solve(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.nrows() == 1 {
        let pivot = matrix[(0, 0)];
        return right.map(|value| if pivot == 0.0 { 0.0 } else { value / pivot });
    }
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return DMatrix::repeat(matrix.ncols(), right.ncols(), f64::NAN);
    }
    // Singular values below 1e-12 of the largest count as 0: they are rounding errors.
    SingularValues::of(matrix.clone()).solve(right, 1e-12)
}
