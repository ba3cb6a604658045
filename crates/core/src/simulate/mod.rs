//! The exact periodic response of a servo axis to a periodic input.
//!
//! The base model: with K taken out (v = K·x) the mechanics are
//! x' = −a·x + τ − f. Between two switches of the friction this is linear, so x
//! is known in closed form and a periodic motion is nothing but its switching
//! instants ([`Orbit`]): `cosine` finds them for a pure cosine, `periodic` for
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

mod bent;
mod bent_cosine;
mod cosine;
mod drive;
mod excitation;
mod fourier;
mod hybrid;
mod orbit;
mod pair;
mod periodic;
mod rate_limit;
mod relaxation;
mod samples;
mod sensitivity;
mod sensor;
mod shooting;
mod slides;
mod spectrum;
mod switching;
mod torque;
mod transient;
mod wave;

pub use excitation::Excitation;
pub use orbit::{Motion, Orbit, Phase};
pub use torque::{Torque, respond_to_torques};
pub use transient::{InitialState, Quantity, SampledInput, Trajectory, Unknown, follow, unknowns};

use crate::effects::{self, ActiveEffect, Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Actuator, Plant, Scalar};
use samples::Samples;
use sensitivity::Direction;

/// There is no response of the excitation's own period.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoResponse {
    /// The motion from rest does not settle to the period of the input.
    #[error("the motion does not settle to the period of the input within {periods} periods")]
    NotPeriodic {
        /// Periods simulated.
        periods: usize,
    },
    /// A motion that need not repeat switches without end.
    #[error("the motion switches so often that it cannot be followed")]
    Endless,
    /// A parameter is not a finite number or has no physical meaning.
    #[error("the plant has no response: {reason}")]
    Unphysical {
        /// Which parameter.
        reason: &'static str,
    },
}

/// Which periodic motions count as a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counts {
    /// The one reached from rest.
    FromRest,
    /// Where the motion from rest does not settle to the period of the input, an unstable motion
    /// of that period too: a search passes through such places, and should not stand before a
    /// wall there.
    EvenUnstable,
}

/// Velocity harmonics and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// V₀ … V_H as the sensor reports them, response units.
    pub velocity: Vec<Complex>,
    /// One row for each variable, with the derivatives of V₀ … V_H.
    pub sensitivities: Vec<Vec<Complex>>,
}

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
    } else if bent::applies(&axis, excitation) {
        bent::respond(&axis, excitation, highest)?
    } else if axis.is_piecewise_linear() {
        slides::respond(&axis, excitation, highest)?
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
    } else if bent::applies(&axis, excitation) {
        bent::differentiate(&axis, &values, excitation, highest, rows)?
    } else if axis.is_piecewise_linear() {
        slides::differentiate(&axis, &values, excitation, highest, rows)?
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
pub fn orbit(plant: &Plant, excitation: &Excitation) -> Result<Orbit, NoResponse> {
    let axis = Axis::base(*plant);
    check(&axis)?;
    settle(&axis, excitation).map(|settled| settled.orbit)
}

/// A plant, the torque on its mechanics, and the motion it leads to.
struct Settled<'a> {
    plant: Plant,
    excitation: &'a Excitation,
    /// Torque lines Tₗ = A(jlω)·Uₗ.
    lines: Vec<Complex>,
    orbit: Orbit,
    /// The torque on the grid, where the input is general.
    torque: Option<Samples>,
}

impl Settled<'_> {
    /// Whether the axis never moves.
    fn rests(&self) -> bool {
        !self.orbit.switches() && self.orbit.phases[0].motion == Motion::Stuck
    }

    /// ∫ τ exp(−jkωt) dt over the phases of rest, k = 0 … `highest`.
    fn held(&self, highest: usize) -> Vec<Complex> {
        match &self.torque {
            Some(torque) => self.held_samples(torque, highest),
            None => spectrum::held_lines(&self.orbit, &self.lines, highest),
        }
    }

    /// The same for a signal of other lines, such as a change of the torque.
    fn held_of(&self, lines: &[Complex], highest: usize) -> Vec<Complex> {
        match self.excitation.grid() {
            Some(grid) if self.orbit.sticks() => {
                let omega = self.excitation.omega_rad_s();
                let (signal, _) = Samples::of(grid, omega, lines, &[]);
                self.held_samples(&signal, highest)
            }
            Some(_) => vec![Complex::new(0.0, 0.0); highest + 1],
            None => spectrum::held_lines(&self.orbit, lines, highest),
        }
    }

    fn held_samples(&self, signal: &Samples, highest: usize) -> Vec<Complex> {
        let stuck = (0..self.orbit.phases.len())
            .map(|i| self.orbit.span(i))
            .filter(|(_, _, motion)| *motion == Motion::Stuck)
            .map(|(start, end, _)| (start, end));
        match self.excitation.grid() {
            Some(grid) if self.orbit.sticks() => {
                signal.integrals(grid, self.excitation.omega_rad_s(), stuck, highest)
            }
            _ => vec![Complex::new(0.0, 0.0); highest + 1],
        }
    }
}

/// The base model's motion, with the friction levels of the axis.
fn settle<'a>(axis: &Axis, excitation: &'a Excitation) -> Result<Settled<'a>, NoResponse> {
    let plant = Plant { friction: axis.levels(), ..axis.plant };
    let lines = excitation.torque_lines(&plant.actuator);
    let (orbit, torque) = match excitation.grid() {
        None => (cosine::orbit(&plant, lines[1], excitation.omega_rad_s())?, None),
        Some(grid) => {
            let (orbit, torque) = periodic::orbit(&plant, &lines, excitation, grid)?;
            (orbit, Some(torque))
        }
    };
    Ok(Settled { plant, excitation, lines, orbit, torque })
}

fn check(axis: &Axis) -> Result<(), NoResponse> {
    let (plant, friction) = (&axis.plant, axis.levels());
    let unphysical = |reason| Err(NoResponse::Unphysical { reason });
    let positive = |value: f64| value > 0.0 && value.is_finite();
    if !axis.viscous_rates().into_iter().all(positive) {
        return unphysical("a must be positive and finite");
    }
    if !plant.constant.is_finite() {
        return unphysical("K must be finite");
    }
    let actuator_is_stable = match plant.actuator {
        Actuator::Direct => true,
        Actuator::FirstOrder { corner_rad_s } => positive(corner_rad_s),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            positive(natural_frequency_rad_s) && positive(damping_ratio)
        }
    };
    if !actuator_is_stable {
        return unphysical("the actuator must be stable");
    }
    // Written so that a NaN fails too.
    if !(friction.fc_plus >= 0.0
        && friction.fc_minus >= 0.0
        && friction.fs_plus >= friction.fc_plus
        && friction.fs_minus >= friction.fc_minus)
        && axis.friction_curve.is_none()
    {
        return unphysical("friction levels must be 0 ≤ Fc ≤ Fs");
    }
    if let Some(mass) = axis.second_mass
        && !(positive(mass.load_inertia_fraction)
            && mass.load_inertia_fraction < 1.0
            && positive(mass.stiffness)
            && mass.damping >= 0.0
            && mass.gap >= 0.0)
    {
        return unphysical("a second mass needs 0 < ρ < 1, a stiffness, a damping and a gap ≥ 0");
    }
    if axis.bristle.is_some_and(|sigma| !positive(sigma)) {
        return unphysical("the bristles' stiffness must be positive");
    }
    if axis.rate_limit.is_some_and(|rate| !positive(rate)) {
        return unphysical("the rate limit must be positive");
    }
    if !(axis.delay.is_finite() && axis.sensor_lags.iter().all(|lag| *lag >= 0.0)) {
        return unphysical("a delay must be finite and a lag at least 0");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
