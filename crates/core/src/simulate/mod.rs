//! The exact periodic response of a servo axis to a periodic input.
//!
//! With the gain K taken out (v = K·x), the mechanics of the base model are x' = −a·x + τ − f.
//! Between two switches of the friction f that is linear, and x is known in closed form. Sticking is
//! a constraint of the motion (v = 0 until the torque exceeds the static level), never a smoothed
//! sign function. The actuator is linear and acts ahead of the friction, so that its steady state is
//! a factor on every line of the input.
//!
//! Which way is taken depends on the effects ([`crate::effects`]) of the axis:
//!
//! - `base`: none, or effects that only change its numbers (friction levels, a delay, sensor lags).
//!   The motion is a list of switching times, found by Newton's method; harmonics and derivatives
//!   follow from the times alone.
//! - `piecewise_linear`: static maps and a rate limiter ahead of the actuator, and damping that
//!   depends on the direction. The torque is a piecewise quintic, under which the motion is exact.
//! - `hybrid`: everything else. The equations are integrated step by step, exactly where they are
//!   affine and by a Runge–Kutta pair otherwise, and every switch is located as an event.
//!
//! `transient` integrates the response to an input that need not repeat, from a given state, by
//! `hybrid`. `sensor` adds what the sensor and a delay do to the harmonics. `signal` holds what all
//! of them are made of.
//!
//! The last two ways are written for any [`Scalar`]: in dual numbers, the same code gives the
//! derivatives by every parameter, and by the state at the beginning of the period, which Newton's
//! method needs to make the motion periodic (`shooting`).

mod base;
mod hybrid;
mod piecewise_linear;
mod response;
mod sensor;
mod shooting;
mod signal;
mod transient;

pub use base::switching_times::{Motion, Phase, SwitchingTimes};
pub use base::torque_sensitivity::{Torque, respond_to_torques};
pub use response::{Counts, NoResponse, Response};
pub use signal::excitation::Excitation;
pub use transient::{InitialState, Quantity, SampledInput, Trajectory, Unknown, follow, unknowns};

use crate::effects::{self, ActiveEffect, Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Plant, Scalar};
use base::sensitivity::{self, Direction};
use base::{settle, spectrum};
use piecewise_linear::stick_slip_periodic;
use response::check;

/// Simulates the periodic response reached from rest.
///
/// `highest` is the highest harmonic wanted. For the base model the result is
/// exact up to rounding for a pure cosine, and up to the interpolation of the
/// torque between samples (relative 1e-7) otherwise. With effects it is within
/// 1e-5 (with play 3e-5) of the largest response of a design, mostly within 1e-6.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond(
    plant: &Plant,
    effects: &[ActiveEffect],
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    respond_if(Counts::FromRest, plant, effects, excitation, highest)
}

/// Like [`respond`], of a motion that `counts`.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond_if(
    counts: Counts,
    plant: &Plant,
    effects: &[ActiveEffect],
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    let axis = effects::enter_values(*plant, effects, excitation.run_share());
    check(&axis)?;
    let mut velocity = if axis.is_base() {
        let settled = settle(&axis, excitation)?;
        spectrum::velocity(&settled, highest)
    } else if axis.is_piecewise_linear() {
        stick_slip_periodic::respond(&axis, excitation, highest)?
    } else {
        hybrid::respond(&axis, excitation, highest, counts)?
    };
    sensor::report(&axis, excitation.omega_rad_s(), &mut velocity, &mut []);
    Ok(velocity)
}

/// Like [`respond_if`], with the derivative of every harmonic by every variable:
/// the first `variables` lanes of the plant, then the effects' parameters in
/// order.
///
/// # Errors
/// See [`NoResponse`].
///
/// # Panics
/// If all variables together are more than [`effects::WIDE_LANES`].
pub fn respond_with_sensitivities(
    counts: Counts,
    plant: &Plant<Wide>,
    variables: usize,
    effects: &[ActiveEffect],
    excitation: &Excitation,
    highest: usize,
) -> Result<Response, NoResponse> {
    let axis = effects::enter(*plant, effects, excitation.run_share(), variables);
    let values = axis.map(Scalar::value);
    check(&values)?;
    let rows = variables + effects.iter().map(|effect| effect.values().len()).sum::<usize>();
    let (mut velocity, mut sensitivities) = if axis.is_base() {
        let settled = settle(&values, excitation)?;
        let velocity = spectrum::velocity(&settled, highest);
        let directions = sensitivity::parameter_directions(&settled.plant, excitation);
        let by_number = sensitivity::along(&settled, &velocity, &directions);
        let rows = sensitivity::by_lane(&axis, &velocity, &by_number, rows);
        (velocity, rows)
    } else if axis.is_piecewise_linear() {
        stick_slip_periodic::differentiate(&axis, &values, excitation, highest, rows)?
    } else {
        hybrid::differentiate(&axis, &values, excitation, highest, rows, counts)?
    };
    sensor::report(&axis, excitation.omega_rad_s(), &mut velocity, &mut sensitivities);
    Ok(Response { velocity, sensitivities })
}

/// The change of every velocity harmonic when the input changes by each of
/// `deviations` (rows of δU₀, δU₁ …), to first order, switching included.
/// Effects that leave the base model's motion act; others are left out of the
/// change.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond_to_deviations(
    plant: &Plant,
    effects: &[ActiveEffect],
    excitation: &Excitation,
    highest: usize,
    deviations: &[&[Complex]],
) -> Result<Vec<Vec<Complex>>, NoResponse> {
    let axis = effects::enter_values(*plant, effects, excitation.run_share());
    check(&axis)?;
    let settled = settle(&axis, excitation)?;
    let velocity = spectrum::velocity(&settled, highest);
    let directions: Vec<Direction> = deviations
        .iter()
        .map(|deviation| Direction::of_input(&settled.plant, excitation, deviation))
        .collect();
    let mut changes = sensitivity::along(&settled, &velocity, &directions);
    for change in &mut changes {
        sensor::report(&axis, excitation.omega_rad_s(), change, &mut []);
    }
    Ok(changes)
}

/// Switching instants of the base model's motion, for those who want to see it.
///
/// # Errors
/// See [`NoResponse`].
pub fn orbit(plant: &Plant, excitation: &Excitation) -> Result<SwitchingTimes, NoResponse> {
    let axis = Axis::base(*plant);
    check(&axis)?;
    settle(&axis, excitation).map(|settled| settled.orbit)
}

#[cfg(test)]
mod tests;
