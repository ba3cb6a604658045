//! The exact periodic response of a servo axis to a periodic input.
//!
//! With K taken out (v = K·x) the mechanics are x' = −a·x + τ − f. Between two
//! switches of the friction this is linear, so x is known in closed form and a
//! periodic motion is nothing but its switching instants ([`Orbit`]):
//! `cosine` finds them for a pure cosine, `periodic` for any periodic input.
//! The harmonics follow from the instants alone (`spectrum`), and so do their
//! derivatives (`sensitivity`). Sticking is a constraint of the motion, never
//! a smoothed sign. The actuator is linear and upstream of the friction: its
//! steady state is closed form and every order costs the same.

mod cosine;
mod excitation;
mod orbit;
mod periodic;
mod samples;
mod sensitivity;
mod spectrum;

pub use excitation::Excitation;
pub use orbit::{Motion, Orbit, Phase};
pub use sensitivity::PARAMETERS;

use crate::effects::{self, Effect};
use crate::measurement::Complex;
use crate::plant::{Actuator, Plant};
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
    /// A parameter is not a finite number or has no physical meaning.
    #[error("the plant has no response: {reason}")]
    Unphysical {
        /// Which parameter.
        reason: &'static str,
    },
}

/// Velocity harmonics and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// V₀ … V_H, response units.
    pub velocity: Vec<Complex>,
    /// One row for each of [`PARAMETERS`], with the derivatives of V₀ … V_H;
    /// empty where not asked for. Rows of actuator parameters the plant does
    /// not have are zero.
    pub sensitivities: Vec<Vec<Complex>>,
}

/// Simulates the periodic response reached from rest.
///
/// `highest` is the highest harmonic wanted. The result is exact up to
/// rounding for a pure cosine, and up to the interpolation of the torque
/// between samples (relative 1e-7) otherwise.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond(
    plant: &Plant,
    effects: &[Box<dyn Effect>],
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    let settled = settle(plant, effects, excitation)?;
    Ok(spectrum::velocity(&settled, highest))
}

/// Like [`respond`], with the derivative of every harmonic by every parameter.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond_with_sensitivities(
    plant: &Plant,
    effects: &[Box<dyn Effect>],
    excitation: &Excitation,
    highest: usize,
) -> Result<Response, NoResponse> {
    let settled = settle(plant, effects, excitation)?;
    let velocity = spectrum::velocity(&settled, highest);
    let directions = sensitivity::parameter_directions(&settled.plant, excitation);
    let mut sensitivities = sensitivity::along(&settled, &velocity, &directions);
    // K scales the response and nothing else.
    let by_constant = velocity.iter().map(|v| v / settled.plant.constant).collect();
    sensitivities.insert(1, by_constant);
    Ok(Response { velocity, sensitivities })
}

/// The change of every velocity harmonic when the input changes by each of
/// `deviations` (rows of δU₀, δU₁ …), to first order, switching included.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond_to_deviations(
    plant: &Plant,
    effects: &[Box<dyn Effect>],
    excitation: &Excitation,
    highest: usize,
    deviations: &[&[Complex]],
) -> Result<Vec<Vec<Complex>>, NoResponse> {
    let settled = settle(plant, effects, excitation)?;
    let velocity = spectrum::velocity(&settled, highest);
    let directions: Vec<Direction> = deviations
        .iter()
        .map(|deviation| Direction::of_input(&settled.plant, excitation, deviation))
        .collect();
    Ok(sensitivity::along(&settled, &velocity, &directions))
}

/// Switching instants of the motion, for those who want to see it.
///
/// # Errors
/// See [`NoResponse`].
pub fn orbit(
    plant: &Plant,
    effects: &[Box<dyn Effect>],
    excitation: &Excitation,
) -> Result<Orbit, NoResponse> {
    settle(plant, effects, excitation).map(|settled| settled.orbit)
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
            None => spectrum::held_cosine(&self.orbit, self.lines[1], highest),
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
            None => spectrum::held_cosine(&self.orbit, lines[1], highest),
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

fn settle<'a>(
    plant: &Plant,
    effects: &[Box<dyn Effect>],
    excitation: &'a Excitation,
) -> Result<Settled<'a>, NoResponse> {
    let plant = effects::enter(plant, effects);
    check(&plant)?;
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

fn check(plant: &Plant) -> Result<(), NoResponse> {
    let friction = plant.friction;
    let unphysical = |reason| Err(NoResponse::Unphysical { reason });
    if !(plant.viscous_rate_rad_s > 0.0 && plant.viscous_rate_rad_s.is_finite()) {
        return unphysical("a must be positive and finite");
    }
    if !plant.constant.is_finite() {
        return unphysical("K must be finite");
    }
    let actuator_is_stable = match plant.actuator {
        Actuator::Direct => true,
        Actuator::FirstOrder { corner_rad_s: p } => p > 0.0 && p.is_finite(),
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            wn > 0.0 && wn.is_finite() && zeta > 0.0 && zeta.is_finite()
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
    {
        return unphysical("friction levels must be 0 ≤ Fc ≤ Fs");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
