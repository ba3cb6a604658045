//! Plain time stepping of a servo axis with set-valued friction.
//!
//! ```text
//!   u ─ signal chain ─ A(s) ─ τ ─ mechanics and friction ─ v ─ sensor ─ harmonics
//!       └────── drive ──────┘    └────── mechanics ─────┘
//! ```
//!
//! - `drive`: nothing of the axis acts back on its actuator, so the torque τ(t) is
//!   stepped once, over one period, from the actuator's own periodic state.
//! - `mechanics`: the equations of motion, and when friction holds or lets go.
//! - `stepping`: classical Runge–Kutta steps of fixed length. Where the velocity reaches
//!   zero or the torque leaves the static band within a step, the instant is found by
//!   bisection and the step is cut there; no step crosses a kink.
//! - `fourier`: Simpson's rule over every piece of a step.
//!
//! The axis starts at rest and runs until a period ends as it began; the harmonics are
//! those of one more period. All rules are of fourth order, and so is the result: half
//! the step, a sixteenth of the error. At the default settings it is near 1e-9 of the
//! largest harmonic. A visit to v = 0 or to the static level that begins and ends
//! within one step is not seen: it moves v by no more than the square of the step.

mod drive;
mod effect;
mod fourier;
mod mechanics;
mod stepping;

use std::f64::consts::TAU;

use crate::measurement::Complex;
use crate::plant::{Actuator, Plant};
use drive::Drive;
pub use effect::{Effect, EffectError};
use fourier::FourierSeries;
use mechanics::{Mechanics, STATES, VELOCITY};
use stepping::Axis;

/// More steps a period than this mean a time constant that no servo axis has.
const MOST_STEPS: usize = 1 << 20;

/// A servo axis and what it has beyond the base model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine<'a> {
    /// The base model.
    pub plant: Plant,
    /// Effects that act together; no id twice. Static friction here replaces the plant's.
    pub effects: &'a [Effect],
}

impl Machine<'_> {
    /// The base model alone.
    pub fn base(plant: Plant) -> Self {
        Self { plant, effects: &[] }
    }
}

/// How finely and how long to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Least number of steps a period.
    pub steps_per_period: usize,
    /// Least number of steps a period of the highest line of the input.
    pub steps_per_input_line: usize,
    /// Least number of steps a time constant, the reciprocal of the plant's fastest
    /// rate (a, p or ωₙ).
    pub steps_per_time_constant: f64,
    /// What transients may leave, as a share of the largest value of each state.
    pub tolerance: f64,
    /// Periods after which the response counts as not periodic.
    pub most_periods: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            steps_per_period: 2048,
            steps_per_input_line: 64,
            steps_per_time_constant: 10.0,
            tolerance: 1e-9,
            most_periods: 10_000,
        }
    }
}

/// Why there is no response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulatorError {
    /// A number that no axis has.
    #[error("{quantity} is {value}: it must be finite and {requirement}")]
    Unusable {
        /// Which number.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// An effect that no machine has.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The same effect more than once.
    #[error("`{id}` is given more than once")]
    Repeated {
        /// Which effect.
        id: &'static str,
    },
    /// The period is too long for the plant's fastest time constant.
    #[error("a period would take {steps} steps, more than {MOST_STEPS}")]
    TooManySteps {
        /// Steps a period that the settings ask for.
        steps: f64,
    },
    /// No response of the input's own period was reached from rest.
    #[error("after {periods} periods the state still changes by {change:e} of its range a period")]
    NotPeriodic {
        /// Periods simulated.
        periods: usize,
        /// Change over the last period, as a share of the state's largest value.
        change: f64,
    },
}

/// Velocity harmonics V₀ … V_H of the periodic response reached from rest.
///
/// `input` are U₀, U₁ … in input units: u(t) = Re Σ Uₖ exp(jkωt); likewise
/// v(t) = Re Σ Vₖ exp(jkωt), peak amplitudes in response units, V₀ real. `harmonics`
/// is H, the highest one wanted. `run_share` is (run − run_min)/(run_max − run_min), from
/// 0 to 1: where in the order of acquisition the experiment stands.
///
/// # Errors
/// See [`SimulatorError`].
pub fn respond(
    machine: &Machine,
    run_share: f64,
    omega_rad_s: f64,
    input: &[Complex],
    harmonics: usize,
    settings: &Settings,
) -> Result<Vec<Complex>, SimulatorError> {
    let (plant, _) = (&machine.plant, run_share);
    check(plant, omega_rad_s, input)?;
    let steps = steps_per_period(plant, omega_rad_s, input, settings)?;
    let step_s = TAU / omega_rad_s / steps as f64;
    let drive = Drive::periodic(&plant.actuator, input, steps, step_s);
    let mut axis = Axis::at_rest(Mechanics::of(plant), &drive, step_s);

    let mut previous_change = f64::INFINITY;
    for _ in 0..settings.most_periods {
        let before = axis.state();
        let mut largest = before.map(f64::abs);
        axis.run_period(&mut |piece| {
            for (largest, value) in largest.iter_mut().zip(piece.end) {
                *largest = largest.max(value.abs());
            }
        });
        let after = axis.state();
        let change = (0..STATES)
            .filter(|&i| largest[i] > 0.0)
            .map(|i| (after[i] - before[i]).abs() / largest[i])
            .fold(0.0, f64::max);
        if settled(change, previous_change, settings.tolerance) {
            let mut series = FourierSeries::new(harmonics, steps);
            axis.run_period(&mut |piece| series.add(piece, VELOCITY));
            return Ok(series.harmonics());
        }
        previous_change = change;
    }
    Err(SimulatorError::NotPeriodic { periods: settings.most_periods, change: previous_change })
}

/// Whether what is left of the transients is below the tolerance: changes that shrink
/// by a factor r a period still add up to change · r/(1 − r).
fn settled(change: f64, previous_change: f64, tolerance: f64) -> bool {
    let shrinks = change < previous_change && previous_change.is_finite();
    let left = change * change / (previous_change - change);
    // Changes of rounding size shrink no more.
    change <= 1e-3 * tolerance || (shrinks && left <= tolerance)
}

/// A power of two, for the Fourier transform that samples the input.
fn steps_per_period(
    plant: &Plant,
    omega_rad_s: f64,
    input: &[Complex],
    settings: &Settings,
) -> Result<usize, SimulatorError> {
    let actuator_rate_rad_s = match plant.actuator {
        Actuator::Direct => 0.0,
        Actuator::FirstOrder { corner_rad_s } => corner_rad_s,
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => natural_frequency_rad_s,
    };
    let fastest_rad_s = plant.viscous_rate_rad_s.max(actuator_rate_rad_s);
    let highest_line = input.iter().rposition(|line| *line != Complex::new(0.0, 0.0)).unwrap_or(0);
    let steps = (TAU * fastest_rad_s / omega_rad_s * settings.steps_per_time_constant)
        .max(settings.steps_per_period as f64)
        .max((highest_line * settings.steps_per_input_line) as f64);
    if steps <= MOST_STEPS as f64 {
        Ok((steps.ceil() as usize).next_power_of_two())
    } else {
        Err(SimulatorError::TooManySteps { steps })
    }
}

fn check(plant: &Plant, omega_rad_s: f64, input: &[Complex]) -> Result<(), SimulatorError> {
    let positive = |quantity, value: f64| {
        let requirement = "positive";
        let usable = value.is_finite() && value > 0.0;
        usable.then_some(()).ok_or(SimulatorError::Unusable { quantity, value, requirement })
    };
    let level = |quantity, value: f64, least: f64, requirement| {
        let usable = value.is_finite() && value >= least;
        usable.then_some(()).ok_or(SimulatorError::Unusable { quantity, value, requirement })
    };
    positive("the fundamental frequency", omega_rad_s)?;
    positive("a", plant.viscous_rate_rad_s)?;
    positive("K", plant.constant)?;
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => positive("the actuator's corner", corner_rad_s)?,
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            positive("the actuator's natural frequency", natural_frequency_rad_s)?;
            positive("the actuator's damping ratio", damping_ratio)?;
        }
    }
    let friction = &plant.friction;
    level("Fc+", friction.fc_plus, 0.0, "at least 0")?;
    level("Fc-", friction.fc_minus, 0.0, "at least 0")?;
    level("Fs+", friction.fs_plus, friction.fc_plus, "at least Fc+")?;
    level("Fs-", friction.fs_minus, friction.fc_minus, "at least Fc-")?;
    for value in input.iter().flat_map(|line| [line.re, line.im]) {
        level("a line of the input", value, f64::NEG_INFINITY, "a number")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
