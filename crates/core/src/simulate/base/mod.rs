//! The base model's motion: one mass with Coulomb friction behind a linear actuator.
//!
//! Between two switches of the friction the equation is linear, so that the switching times
//! determine a periodic motion completely. `cosine` finds them for a pure cosine, by Newton's
//! method from a closed form; `periodic` for any periodic input, by integrating the motion until it
//! repeats. Harmonics (`spectrum`) and derivatives (`sensitivity`) follow from the times alone.
//! Without rest under a cosine, all of these have a closed form (`sliding_cosine`).

pub(super) mod cosine;
pub(super) mod periodic;
pub(super) mod respond;
pub(super) mod sensitivity;
mod sliding_cosine;
pub(super) mod spectrum;
pub(super) mod switching_times;
pub(super) mod torque_sensitivity;
mod turns;
mod two_slides;

use crate::effects::Axis;
use crate::measurement::Complex;
use crate::plant::{Plant, Scalar};

use super::response::NoResponse;
use super::signal::excitation::Excitation;
use super::signal::samples::Samples;
use spectrum::PhaseIntegrals;
use switching_times::{Motion, SwitchingTimes};

/// A plant, the torque on its mechanics, and the periodic motion under that torque.
pub(super) struct Settled<'a> {
    pub(super) plant: Plant,
    pub(super) excitation: &'a Excitation,
    /// Torque lines Tₗ = A(jlω)·Uₗ.
    pub(super) lines: Vec<Complex>,
    pub(super) orbit: SwitchingTimes,
    /// The torque sampled on the grid; `None` for a pure cosine.
    torque: Option<Samples>,
}

impl Settled<'_> {
    /// Whether the axis never moves.
    pub(super) fn rests(&self) -> bool {
        !self.orbit.switches() && self.orbit.phases[0].motion == Motion::Stuck
    }

    /// ∫ exp(−jkωt) dt over the phases of each kind, k = 0 … `highest`, and one more for
    /// [`Self::held`] of a cosine.
    pub(super) fn integrals(&self, highest: usize) -> PhaseIntegrals {
        let one_more = usize::from(self.excitation.is_pure_cosine());
        PhaseIntegrals::new(&self.orbit, highest + one_more)
    }

    /// ∫ τ exp(−jkωt) dt over the phases of rest, where the friction equals the torque;
    /// k = 0 … `highest`.
    pub(super) fn held(&self, integrals: &PhaseIntegrals, highest: usize) -> Vec<Complex> {
        match &self.torque {
            Some(torque) => self.held_samples(torque, highest),
            None => spectrum::held_lines(&self.orbit, integrals, &self.lines, highest),
        }
    }

    /// The same for a signal of other lines, such as a change of the torque.
    pub(super) fn held_of(
        &self,
        lines: &[Complex],
        integrals: &PhaseIntegrals,
        highest: usize,
    ) -> Vec<Complex> {
        match self.excitation.grid() {
            Some(grid) if self.orbit.sticks() => {
                let omega = self.excitation.omega_rad_s();
                let (signal, _) = Samples::of(grid, omega, lines, &[]);
                self.held_samples(&signal, highest)
            }
            Some(_) => vec![Complex::new(0.0, 0.0); highest + 1],
            None => spectrum::held_lines(&self.orbit, integrals, lines, highest),
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

/// The plant with the friction levels of the axis.
pub(super) fn plant<S: Scalar>(axis: &Axis<S>) -> Plant<S> {
    Plant { friction: axis.levels(), ..axis.plant }
}

/// Finds the periodic motion of the base model with the plant and the friction levels of the axis.
/// All other effects are ignored.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(super) fn settle<'a>(
    axis: &Axis,
    excitation: &'a Excitation,
) -> Result<Settled<'a>, NoResponse> {
    settle_by(plant(axis), excitation, cosine::orbit)
}

/// The same where [`sliding_cosine`] has found nothing.
fn settle_not_sliding(plant: Plant, excitation: &Excitation) -> Result<Settled<'_>, NoResponse> {
    settle_by(plant, excitation, cosine::orbit_with_rest)
}

/// `of_cosine` finds the motion under a pure cosine.
fn settle_by(
    plant: Plant,
    excitation: &Excitation,
    of_cosine: impl Fn(&Plant, Complex, f64) -> Result<SwitchingTimes, NoResponse>,
) -> Result<Settled<'_>, NoResponse> {
    let lines = excitation.torque_lines(&plant.actuator);
    let (orbit, torque) = match excitation.grid() {
        None => (of_cosine(&plant, lines[1], excitation.omega_rad_s())?, None),
        Some(grid) => {
            let (orbit, torque) = periodic::orbit(&plant, &lines, excitation, grid)?;
            (orbit, Some(torque))
        }
    };
    Ok(Settled { plant, excitation, lines, orbit, torque })
}
