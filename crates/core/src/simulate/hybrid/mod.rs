//! Axes that are not linear between switches, have two masses, or depend on the position: numerical
//! integration with event location, and Newton's method for the periodic motion.
//!
//! - `mechanics`: the equations of motion in each mode (sliding, sticking, contact or gap).
//! - `affine`, `series`, `runge_kutta`: one step: exactly, where the equations are affine; by
//!   Taylor series, where its terms are known; by the Dormand–Prince pair otherwise. `step_control`
//!   chooses among them and sets the length; `step` is the result.
//! - `crossing`: the zeros of a signal within a step.
//! - `integrate_period`: the integration over one period, through every switch.
//! - `companion`: what the integration tells of its steps.
//! - `sensitivity`: the derivatives by parameters and by the state at the beginning, carried along
//!   with the integration.
//! - `return_map`: the state at the beginning of the period, by Newton's method on the return map
//!   (single shooting).
//! - `initial_value`: a motion that need not be periodic.
//!
//! Where several periodic motions exist, the one reached from rest counts.

mod affine;
mod companion;
mod crossing;
mod initial_value;
mod integrate_period;
mod mechanics;
mod return_map;
mod runge_kutta;
mod sensitivity;
mod series;
mod step;
mod step_control;

use std::ops::Range;

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Dual, Scalar as _};

use super::piecewise_linear::drive::{self, TorqueDerivatives};
use super::response::{Counts, NoResponse};
use super::shooting;
use super::signal::complex_dual::ComplexDual;
use super::signal::excitation::Excitation;
pub(super) use initial_value::follow;
use mechanics::{MOST_STATES, Mechanics};
use return_map::{PeriodResult, Periodic};

/// Fewest cells of a period of a cosine for the reported motion: the quintics then err by 8e-8.
const FEWEST_CELLS: usize = 16;

/// Velocity harmonics of the periodic motion reached from rest, or of another one if `counts`
/// allows it.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(super) fn respond(
    axis: &Axis,
    excitation: &Excitation,
    highest: usize,
    counts: Counts<'_>,
) -> Result<Vec<Complex>, NoResponse> {
    match Mechanics::new(axis).states {
        1 => velocity::<1>(axis, excitation, highest, counts),
        2 => velocity::<2>(axis, excitation, highest, counts),
        3 => velocity::<3>(axis, excitation, highest, counts),
        4 => velocity::<4>(axis, excitation, highest, counts),
        _ => velocity::<MOST_STATES>(axis, excitation, highest, counts),
    }
}

/// The same, with derivatives by the first `rows` lanes of the axis, one row per lane.
pub(super) fn differentiate(
    axis: &Axis<Wide>,
    values: &Axis,
    excitation: &Excitation,
    highest: usize,
    rows: usize,
    counts: Counts<'_>,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let request = (excitation, highest, counts);
    let next = |first: usize| match (Mechanics::new(values).states, rows) {
        (1, ..=7) => chunk::<1, 8>(axis, values, request, first..rows),
        (1, _) => chunk::<1, 16>(axis, values, request, first..rows),
        (2, ..=6) => chunk::<2, 8>(axis, values, request, first..rows),
        (2, _) => chunk::<2, 16>(axis, values, request, first..rows),
        (3, ..=9) => chunk::<3, 12>(axis, values, request, first..rows),
        (3, _) => chunk::<3, 16>(axis, values, request, first..rows),
        (4, ..=8) => chunk::<4, 12>(axis, values, request, first..rows),
        (4, _) => chunk::<4, 16>(axis, values, request, first..rows),
        _ => chunk::<MOST_STATES, 16>(axis, values, request, first..rows),
    };
    let (velocity, mut sensitivities) = next(0)?;
    while sensitivities.len() < rows {
        sensitivities.extend(next(sensitivities.len())?.1);
    }
    Ok((velocity, sensitivities))
}

/// Number of cells of a period of a cosine, for harmonics up to `highest`.
fn cells(highest: usize) -> usize {
    FEWEST_CELLS.max(2 * highest)
}

fn velocity<const M: usize>(
    axis: &Axis,
    excitation: &Excitation,
    highest: usize,
    counts: Counts<'_>,
) -> Result<Vec<Complex>, NoResponse> {
    let Some(mut periodic) = Periodic::<M>::find(axis, excitation, counts)? else {
        return Ok(vec![Complex::new(0.0, 0.0); highest + 1]);
    };
    let (forcing, grid) = drive::torque(axis, excitation, cells(highest));
    let drive = (forcing, TorqueDerivatives::NONE, grid);
    let followed = periodic.velocity(&axis.map(Dual::<M>::constant), drive, highest, 0)?;
    periodic.remember(counts);
    Ok(followed.velocity.into_iter().map(ComplexDual::value).collect())
}

/// Velocity harmonics, and derivatives by the first of the lanes `rows`: as many as fit in N lanes
/// beside the M unknowns.
fn chunk<const M: usize, const N: usize>(
    axis: &Axis<Wide>,
    values: &Axis,
    (excitation, highest, counts): (&Excitation, usize, Counts<'_>),
    rows: Range<usize>,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let Some(mut periodic) = Periodic::<M>::find(values, excitation, counts)? else {
        let zero = vec![Complex::new(0.0, 0.0); highest + 1];
        return Ok((zero.clone(), vec![zero; rows.len()]));
    };
    let count = rows.len().min(N - M);
    let narrow = shooting::narrowed::<N>(axis, rows.start, count);
    let drive = drive::torque_and_derivatives(&narrow, excitation, cells(highest));
    let PeriodResult { velocity, residuals } = periodic.velocity(&narrow, drive, highest, count)?;
    periodic.remember(counts);
    let rows = shooting::differentiate(&velocity, &residuals, count);
    Ok((velocity.into_iter().map(ComplexDual::value).collect(), rows))
}
