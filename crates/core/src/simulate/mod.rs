//! The exact periodic response of a servo axis to a periodic input.
//!
//! The base model: with K taken out (v = K·x) the mechanics are
//! x' = −a·x + τ − f. Between two switches of the friction this is linear, so x
//! is known in closed form and a periodic motion is nothing but its switching
//! instants ([`SwitchingTimes`]): `cosine` finds them for a pure cosine, `periodic` for
//! any periodic input. The harmonics follow from the instants alone (`spectrum`),
//! and so do their derivatives (`sensitivity`). Sticking is a constraint of the
//! motion, never a smoothed sign. The actuator is linear and upstream of the
//! friction: its steady state is closed form and every order costs the same.
//!
//! With effects ([`crate::effects`]) one of four ways is taken:
//!
//! - Levels that change, delays and sensor lags leave the base model's motion:
//!   other numbers go in, and every harmonic takes a factor (`sensor`).
//! - A cosine bent by static maps stays closed form behind the actuator
//!   (`bent_cosine`), and so does the motion between its instants (`bent`).
//! - Any other input that is bent (`drive`, `rate_limit`) becomes a wave of quintics
//!   (`wave`); damping may depend on the direction. Slides are still exact for each
//!   quintic (`relaxation`, `switching`), and `slides` closes them to a period.
//! - Everything else goes to `hybrid`: exact steps where the equations are affine,
//!   Runge–Kutta steps under error control otherwise, cut at every switch.
//!
//! An input that need not repeat is followed once, from a given state (`transient`), by the
//! last of these ways.
//!
//! The last two are written for any [`Scalar`]: in dual numbers the same code
//! gives the derivatives by every number of the axis, and by the state at the
//! beginning of the period, which Newton's method needs to close it (`shooting`).

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
use piecewise_linear::{static_map_response, stick_slip_periodic};
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
    } else if static_map_response::applies(&axis, excitation) {
        static_map_response::respond(&axis, excitation, highest)?
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
    } else if static_map_response::applies(&axis, excitation) {
        static_map_response::differentiate(&axis, &values, excitation, highest, rows)?
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
