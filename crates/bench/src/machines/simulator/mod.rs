//! Time-stepping simulator of a servo axis with set-valued friction and effects beyond the base
//! model, independent of `servoscope-core`.
//!
//! ```text
//!   u ─ signal chain ─ A(s) ─ τ ─ mechanics and friction ─ v ─ sensor ─ harmonics
//!       └ chain, slew ┘
//!       └────── drive ──────┘    └─ mechanics, friction ─┘
//! ```
//!
//! - `effect`: an effect with values for its parameters; `physics`: what each effect changes in the
//!   `parts` of a machine.
//! - `check`: which machines and inputs can be simulated.
//! - `input`: a periodic input. `chain`, `shape`, `slew`: delay, dead zone, gain asymmetry,
//!   saturation and slew limit convert it into a command that is smooth within each of a sequence of
//!   stretches.
//! - `drive`: the axis does not act back on its actuator, so the torque τ(t) is computed first, for
//!   one period, from the actuator's own periodic state.
//! - `mechanics`, `friction`: the equations of motion, and the switching between sticking and
//!   sliding.
//! - `stepping`: classical Runge–Kutta steps of fixed length within a stretch. Events (the velocity
//!   reaches zero, the torque leaves the static band, a joint crosses an edge of its gap) are
//!   located by bisection, and the step is cut there, so that no step crosses a kink.
//! - `shooting`, `floating`, `cogging`: the periodic state, i.e. the initial state that one period
//!   maps to itself.
//! - `transient`: a single motion under a sampled input from a given initial state.
//! - `fourier`: Fourier integrals by Simpson's rule over every piece of a step.
//!
//! The axis starts at rest and runs until its motion is periodic; the harmonics are those of one
//! more period. All rules are of fourth order, so halving the step divides the error by sixteen. At
//! the default settings the error of the base model is near 1e-9 of the largest harmonic. If v = 0
//! or the static level is crossed twice within one step, the step misses it; the resulting error of
//! v is of second order in the step.

mod chain;
mod check;
mod cogging;
mod drive;
mod effect;
mod floating;
mod fourier;
mod friction;
mod input;
mod mechanics;
mod parts;
pub mod physics;
mod shape;
mod shooting;
mod slew;
mod stepping;
mod transient;

use std::f64::consts::TAU;

use crate::measurement::Complex;
use crate::plant::{Actuator, Plant};
use chain::Command;
pub use check::SimulatorError;
use check::check;
use cogging::{CoggingState, cogging_state};
use drive::Drive;
pub use effect::{Effect, Unusable};
use floating::float;
use fourier::FourierSeries;
use mechanics::{Mechanics, VELOCITY};
pub use parts::Parts;
use shooting::{Cycle, Search, settle};
use stepping::Axis;
pub use transient::{Motion, Samples, Start, follow};

/// Most steps per period. Only an unrealistically short time constant would need more.
const MOST_STEPS: usize = 1 << 20;

/// A servo axis: the base model and its effects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine<'a> {
    /// The base model.
    pub plant: Plant,
    /// Effects that act together, each at most once. Static friction here replaces the plant's.
    pub effects: &'a [Effect],
}

impl Machine<'_> {
    /// The base model alone.
    pub fn base(plant: Plant) -> Self {
        Self { plant, effects: &[] }
    }
}

/// Step lengths and stopping criteria.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Least number of steps per period.
    pub steps_per_period: usize,
    /// Least number of steps per period of the highest line of the input.
    pub steps_per_input_line: usize,
    /// Least number of steps per time constant, the reciprocal of the machine's fastest rate.
    pub steps_per_time_constant: f64,
    /// Largest remaining transient, as a share of the largest value of each state.
    pub tolerance: f64,
    /// Number of periods after which the response counts as not periodic.
    pub most_periods: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            steps_per_period: 2048,
            steps_per_input_line: 64,
            steps_per_time_constant: 10.0,
            tolerance: 1e-9,
            most_periods: 2_000,
        }
    }
}

/// Velocity harmonics V₀ … V_H of the periodic response reached from rest.
///
/// `input` is U₀, U₁ … in input units, with u(t) = Re Σ Uₖ exp(jkωt). The result has
/// v(t) = Re Σ Vₖ exp(jkωt), with peak amplitudes in response units and V₀ real. `harmonics` is H,
/// the highest harmonic of the result. `run_share` is the position of the experiment in the order
/// of acquisition, (run − run_min)/(run_max − run_min), from 0 to 1.
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
    check(machine, run_share, omega_rad_s, input)?;
    let Machine { plant, effects } = machine;
    let parts = &Parts::of(effects);
    let mechanics = Mechanics::of(plant, parts, run_share);
    let speed = linear_speed(plant, omega_rad_s, input);
    let fastest_rad_s = mechanics.fastest_rad_s(speed).max(actuator_rate_rad_s(&plant.actuator));
    let steps = steps_per_period(fastest_rad_s, omega_rad_s, input, settings)?;
    let gain = 1.0 + parts.gain_drift * run_share;
    let input: Vec<Complex> = input.iter().map(|line| gain * line).collect();
    let command = Command::periodic(parts, omega_rad_s, &input);
    let longest_step_s = command.period_s() / steps as f64;
    let drive = Drive::periodic(&plant.actuator, &command, longest_step_s);
    let solve = match mechanics.states() {
        1 => periodic_harmonics::<1>,
        2 => periodic_harmonics::<2>,
        3 => periodic_harmonics::<3>,
        4 => periodic_harmonics::<4>,
        _ => periodic_harmonics::<5>,
    };
    let search = Search { settings, speed };
    let Parts { compression, sensor_lag_s, .. } = *parts;
    let mut velocity = solve(&mechanics, &drive, omega_rad_s, harmonics, compression, &search)?;
    if let Some(lag_s) = sensor_lag_s {
        for (k, line) in velocity.iter_mut().enumerate() {
            *line /= Complex::new(1.0, k as f64 * omega_rad_s * lag_s);
        }
    }
    Ok(velocity)
}

/// V₀ … V_H of a machine with N states.
fn periodic_harmonics<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    omega_rad_s: f64,
    harmonics: usize,
    compression: f64,
    search: &Search,
) -> Result<Vec<Complex>, SimulatorError> {
    let at_rest = vec![Complex::new(0.0, 0.0); harmonics + 1];
    let mut series = FourierSeries::new(harmonics, omega_rad_s);
    let (mechanics, state) = if mechanics.has_cogging() {
        let Some(CoggingState { state, constant_torque }) =
            cogging_state::<N>(mechanics, drive, search.settings)?
        else {
            return Ok(at_rest);
        };
        (&mechanics.with_cogging(constant_torque, 1.0), state)
    } else {
        let half_gap = 0.5 * mechanics.gap();
        let twist = mechanics.twist();
        let run = |state: [f64; N]| {
            let mut axis = Axis::new(mechanics, drive, state);
            let mut largest = state.map(f64::abs);
            axis.run_period(&mut |piece| {
                for (largest, value) in largest.iter_mut().zip(piece.end) {
                    *largest = largest.max(value.abs());
                }
            });
            let floats = twist.is_some_and(|twist| largest[twist] < half_gap);
            Cycle { end: axis.state(), largest, floats }
        };
        let period_s = TAU / omega_rad_s;
        let float = |state| float(mechanics, drive, period_s, state, search);
        let Some(state) = settle(&run, &float, [0.0; N], search)? else { return Ok(at_rest) };
        (mechanics, state)
    };
    // Without compression the reading is v/√1, bit-identical to v.
    let reading = |v: f64| v / (1.0 + (compression * v).powi(2)).sqrt();
    let mut axis = Axis::new(mechanics, drive, state);
    axis.run_period(&mut |piece| series.add(piece, VELOCITY, reading));
    Ok(series.harmonics())
}

/// An upper bound on the velocity of the base model without friction: the sum over all lines.
fn linear_speed(plant: &Plant, omega_rad_s: f64, input: &[Complex]) -> f64 {
    let line_speed = |(k, line): (usize, &Complex)| {
        let at = k as f64 * omega_rad_s;
        (plant.actuator.response(at) * plant.mechanics_response(at) * line).norm()
    };
    input.iter().enumerate().map(line_speed).sum()
}

/// The fastest rate of A(s), rad/s.
fn actuator_rate_rad_s(actuator: &Actuator) -> f64 {
    match *actuator {
        Actuator::Direct => 0.0,
        Actuator::FirstOrder { corner_rad_s } => corner_rad_s,
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => natural_frequency_rad_s,
    }
}

/// Number of steps per period; a power of two, because an FFT samples the input.
fn steps_per_period(
    fastest_rad_s: f64,
    omega_rad_s: f64,
    input: &[Complex],
    settings: &Settings,
) -> Result<usize, SimulatorError> {
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

#[cfg(test)]
mod tests;
