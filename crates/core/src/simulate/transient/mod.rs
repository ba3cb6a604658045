//! Transient motion: the response to a sampled input that need not be periodic, from a given state.
//!
//! Between two samples the input is linear or held. Delay, static maps and rate limiter keep it
//! piecewise linear (`command`). The torque behind the actuator is a piecewise quintic that starts
//! from the actuator's given state (`actuator`). The mechanics are integrated once, from the first
//! sample to the last (`hybrid`), and sampled through the sensor's lags (`recorder`).

mod actuator;
mod command;
pub(super) mod motion;
pub(super) mod recorder;

pub use motion::{InitialState, Quantity, SampledInput, Trajectory};

use crate::effects::{self, ActiveEffect, Axis};
use crate::plant::{Actuator, Plant};

use super::hybrid;
use super::response::{NoResponse, check};
use recorder::Recorder;

/// A quantity of the initial state that the motion depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    /// Which.
    pub quantity: Quantity,
    /// Its value at rest under the first sample of the input.
    pub at_rest: f64,
    /// How far it may be from that value. For the position under a torque that is periodic in it,
    /// at most half a period.
    pub size: f64,
}

/// The quantities of the initial state that the motion of an axis depends on, the velocity first.
/// The input begins at `first` and reaches `largest`; the position covers `travel`.
pub fn unknowns(
    plant: &Plant,
    effects: &[ActiveEffect],
    [first, largest]: [f64; 2],
    travel: f64,
) -> Vec<Unknown> {
    let axis = effects::enter_values(*plant, effects, 0.0);
    let slowest = axis.viscous_rates().into_iter().fold(f64::INFINITY, f64::min);
    let speed = largest * axis.plant.constant.abs() / slowest;
    let mut unknowns = Vec::new();
    let mut add = |quantity, at_rest, size| unknowns.push(Unknown { quantity, at_rest, size });
    add(Quantity::Velocity, 0.0, speed);
    match axis.plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { .. } => add(Quantity::Torque, first, largest),
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => {
            add(Quantity::Torque, first, largest);
            add(Quantity::TorqueRate, 0.0, largest * natural_frequency_rad_s);
        }
    }
    if axis.balanced || axis.torques.iter().any(|law| law.form().uses_position()) {
        let ripple = axis.ripple_rate();
        let turn = if ripple > 0.0 { std::f64::consts::PI / ripple } else { f64::INFINITY };
        add(Quantity::Position, 0.0, travel.min(turn));
    }
    if axis.bristle.is_some() {
        add(Quantity::Bristle, 0.0, 1.0);
    }
    if let Some(mass) = axis.second_mass {
        add(Quantity::Twist, 0.0, 0.5 * mass.gap + largest / mass.stiffness);
    }
    if axis.balanced {
        let levels = axis.levels();
        let size = 0.5 * (levels.fc_plus + levels.fc_minus);
        add(Quantity::Balance, 0.5 * (levels.fc_plus - levels.fc_minus), size);
    }
    unknowns
}

/// Simulates the motion from `initial` over all samples of an input, at the position `run_share` in
/// the order of acquisition (0 first, 1 last).
///
/// Affine motions are exact up to rounding and, with an actuator, to 1e-6 of its torque; others to
/// about 1e-6 of their size.
///
/// # Errors
/// [`NoResponse::Unphysical`] for impossible parameters, [`NoResponse::Endless`] if the switching
/// times accumulate.
pub fn follow(
    plant: &Plant,
    effects: &[ActiveEffect],
    run_share: f64,
    input: &SampledInput<'_>,
    initial: &InitialState,
) -> Result<Trajectory, NoResponse> {
    let axis = effects::enter_values(*plant, effects, run_share);
    check(&axis)?;
    let Some(first) = input.values.first() else { return Ok(Trajectory::default()) };
    let axis = with_quick_actuator_as_delay(axis, input.step_s);
    let (lines, input_before) = command::of(&axis, input, *first);
    let forcing = actuator::torque(&axis.plant.actuator, &lines, input_before, initial);
    let mut recorder = Recorder::new(input, &axis.sensor_lags, initial);
    if !forcing.cells.is_empty() {
        hybrid::follow(&axis, &forcing, initial, &mut recorder)?;
    }
    Ok(recorder.finish())
}

/// Largest angle ωₙ·step of an oscillatory actuator between two samples; a faster one is treated as
/// a delay. Tuned.
const MOST_RADIANS_PER_SAMPLE: f64 = 24.0;

/// Replaces an actuator that oscillates many times between two samples by a delay of 2ζ/ωₙ, to
/// which it is equal to first order in s/ωₙ.
fn with_quick_actuator_as_delay(axis: Axis, step_s: f64) -> Axis {
    match axis.plant.actuator {
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta }
            if zeta < 1.0 && wn * step_s > MOST_RADIANS_PER_SAMPLE =>
        {
            let plant = Plant { actuator: Actuator::Direct, ..axis.plant };
            Axis { plant, delay: axis.delay + 2.0 * zeta / wn, ..axis }
        }
        _ => axis,
    }
}

#[cfg(test)]
mod tests;
