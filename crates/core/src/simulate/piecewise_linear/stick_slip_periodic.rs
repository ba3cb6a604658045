//! The periodic stick-slip motion of one mass: a fixed point of the return map, by Newton's method.

use std::ops::Range;

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Dual, Scalar};

use super::drive;
use super::stick_slip_motion::{OneMass, Slides, State};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::response::NoResponse;
use crate::simulate::shooting;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Most Newton steps; after them the motion counts as not periodic.
const MOST_ITERATIONS: usize = 400;

/// Longest Newton step, as a share of x's size, if there may be several periodic motions. A larger
/// change over a period is always allowed. Tuned.
const LONGEST_STEP_SHARE: f64 = 0.2;

/// The motion is periodic if x changes over a period by no more than this share of its size.
const PERIODICITY_TOLERANCE: f64 = 1e-12;

/// Fewest cells of a period of a cosine: the quintics then err by 8e-8.
const FEWEST_CELLS: usize = 16;

/// Number of cells of a period of a cosine, for harmonics up to `highest`.
fn cells(highest: usize) -> usize {
    FEWEST_CELLS.max(2 * highest)
}

/// Velocity harmonics of the periodic motion reached from rest.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(crate) fn respond(
    axis: &Axis,
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    let (forcing, grid) = drive::torque(axis, excitation, cells(highest));
    let mass = OneMass::new(axis, &forcing);
    if mass.rests() {
        return Ok(vec![Complex::new(0.0, 0.0); highest + 1]);
    }
    let start = periodic(&mass, &forcing)?;
    let mut slides = Slides::new(&mass, grid, excitation.omega_rad_s(), highest);
    mass.pass(&forcing, start, Some(&mut slides)).ok_or(NoResponse::NotPeriodic { periods: 1 })?;
    let velocity = slides.velocity(&mass, axis.plant.constant, forcing.period_s);
    Ok(velocity.into_iter().map(|v| v.value()).collect())
}

/// The same with derivatives by the first `rows` lanes of the axis, one row per lane.
pub(crate) fn differentiate(
    axis: &Axis<Wide>,
    values: &Axis,
    excitation: &Excitation,
    highest: usize,
    rows: usize,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let (forcing, _) = drive::torque(values, excitation, cells(highest));
    let mass = OneMass::new(values, &forcing);
    if mass.rests() {
        let zero = vec![Complex::new(0.0, 0.0); highest + 1];
        return Ok((zero.clone(), vec![zero; rows]));
    }
    let start = periodic(&mass, &forcing)?;
    // One lane carries the derivative by the state at the start.
    let run = |first: usize| match rows {
        ..=7 => chunk::<8>(axis, start, excitation, highest, first..rows),
        _ => chunk::<16>(axis, start, excitation, highest, first..rows),
    };
    let (velocity, mut sensitivities) = run(0)?;
    while sensitivities.len() < rows {
        sensitivities.extend(run(sensitivities.len())?.1);
    }
    Ok((velocity, sensitivities))
}

/// Velocity harmonics, and derivatives by the first of the lanes `rows`: as many as fit in N lanes
/// beside the state.
fn chunk<const N: usize>(
    axis: &Axis<Wide>,
    start: State<f64>,
    excitation: &Excitation,
    highest: usize,
    rows: Range<usize>,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let count = rows.len().min(N - 1);
    let narrow = shooting::narrowed::<N>(axis, rows.start, count);
    let (forcing, grid) = drive::torque_of_few(&narrow, excitation, cells(highest));
    let mass = OneMass::new(&narrow, &forcing);
    let x = match start.motion {
        Motion::Stuck => Dual::constant(0.0),
        _ => Dual::variable(start.x, count),
    };
    let mut slides = Slides::new(&mass, grid, excitation.omega_rad_s(), highest);
    let state = State { x, motion: start.motion };
    let end = mass.pass(&forcing, state, Some(&mut slides));
    let end = end.ok_or(NoResponse::NotPeriodic { periods: 1 })?;
    let harmonics = slides.velocity(&mass, narrow.plant.constant, forcing.period_s);
    let residual = match start.motion {
        Motion::Stuck => Dual::constant(0.0),
        _ => end.x - x,
    };
    let sensitivities = shooting::differentiate(&harmonics, &[residual], count);
    Ok((harmonics.iter().map(|v| v.value()).collect(), sensitivities))
}

/// The state at the beginning of the period, for the periodic motion reached from rest.
fn periodic(
    mass: &OneMass<f64>,
    forcing: &PiecewiseQuintic<f64>,
) -> Result<State<f64>, NoResponse> {
    let failed = |periods: usize| NoResponse::NotPeriodic { periods };
    let rest = State { x: 0.0, motion: Motion::Stuck };
    let mut start = mass.pass(forcing, rest, None).ok_or(failed(1))?;
    if start.motion == Motion::Stuck {
        return Ok(start);
    }
    let lifted_forcing = forcing.map(Dual::<1>::constant);
    let lifted = mass.map(Dual::<1>::constant);
    let size = mass.scale();
    for iteration in 1..MOST_ITERATIONS {
        let state = State { x: Dual::<1>::variable(start.x, 0), motion: start.motion };
        let end = lifted.pass(&lifted_forcing, state, None).ok_or(failed(iteration))?;
        let (x, slope) = (end.x.value(), end.x.lane(0));
        let change = x - start.x;
        if end.motion == Motion::Stuck {
            return Ok(State { x, motion: end.motion });
        }
        if end.motion == start.motion && change.abs() <= PERIODICITY_TOLERANCE * size {
            return Ok(start);
        }
        let mut step = change / (1.0 - slope);
        if !mass.contracts() {
            let region = change.abs().max(LONGEST_STEP_SHARE * size);
            step = step.clamp(-region, region);
        }
        let next = start.x + step;
        let same_side = match end.motion {
            Motion::Forward => next > 0.0,
            _ => next < 0.0,
        };
        let jumps = same_side && end.motion == start.motion && slope != 0.0;
        start = State { x: if jumps { next } else { x }, motion: end.motion };
        // The error after a Newton step is of the order of the step squared.
        if jumps && step.abs() <= 1e-6 * size {
            return Ok(start);
        }
    }
    Err(failed(MOST_ITERATIONS))
}
