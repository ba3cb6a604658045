//! Time-stepping simulator of a servo axis with set-valued friction and effects beyond the base
//! model, independent of `servoscope-core`.
//!
//! ```text
//!   u ─ signal chain ─ A(s) ─ τ ─ mechanics and friction ─ v ─ sensor ─ harmonics
//!       └ chain, slew ┘
//!       └────── drive ──────┘    └─ mechanics, friction ─┘
//! ```
//!
//! - `effect`: the effects and their parameters by name; `outsider`: effects that no diagnosis
//!   can name.
//! - `chain`, `slew`: delay, dead zone, gain asymmetry, saturation and slew limit convert the input
//!   into a command that is smooth within each of a sequence of stretches.
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
mod cogging;
mod drive;
mod effect;
mod floating;
mod fourier;
mod friction;
mod mechanics;
mod outsider;
mod shooting;
mod slew;
mod stepping;
mod transient;

use std::f64::consts::TAU;

use crate::measurement::Complex;
use crate::plant::{Actuator, Plant};
use chain::Command;
use cogging::{CoggingState, cogging_state};
use drive::Drive;
pub use effect::{Effect, EffectError};
use floating::float;
use fourier::FourierSeries;
use mechanics::{Mechanics, VELOCITY};
pub use outsider::Outsider;
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

/// Why a machine has no periodic response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulatorError {
    /// A parameter has an invalid value.
    #[error("{quantity} is {value}: it must be finite and {requirement}")]
    Unusable {
        /// Which parameter.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// An effect is invalid.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// An effect is given more than once.
    #[error("`{id}` is given more than once")]
    Repeated {
        /// Which effect.
        id: &'static str,
    },
    /// A joint is given both with and without a gap.
    #[error("`backlash` and `flexible_mode` describe the same joint: give one of them")]
    TwoJoints,
    /// The period is too long for the plant's fastest time constant.
    #[error("a period would take {steps} steps, more than {MOST_STEPS}")]
    TooManySteps {
        /// Steps per period that the settings demand.
        steps: f64,
    },
    /// No response of the input's period is reached from rest.
    #[error("after {periods} periods the state still changes by {change:e} of its range a period")]
    NotPeriodic {
        /// Periods simulated.
        periods: usize,
        /// Change of the state over the last period, as a share of its largest value.
        change: f64,
    },
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
    let mechanics = Mechanics::of(plant, effects, run_share);
    let speed = linear_speed(plant, omega_rad_s, input);
    let fastest_rad_s = mechanics.fastest_rad_s(speed).max(actuator_rate_rad_s(&plant.actuator));
    let steps = steps_per_period(fastest_rad_s, omega_rad_s, input, settings)?;
    let gain = gain(effects, run_share);
    let input: Vec<Complex> = input.iter().map(|line| gain * line).collect();
    let command = Command::periodic(effects, omega_rad_s, &input);
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
    let compression = compression(effects);
    let mut velocity = solve(&mechanics, &drive, omega_rad_s, harmonics, compression, &search)?;
    for effect in *effects {
        if let Effect::SensorLag { time_constant } = effect {
            for (k, line) in velocity.iter_mut().enumerate() {
                *line /= Complex::new(1.0, k as f64 * omega_rad_s * time_constant);
            }
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

/// Factor of the command due to gain drift, at this position in the order of acquisition.
fn gain(effects: &[Effect], run_share: f64) -> f64 {
    let drift = |effect: &Effect| match effect {
        Effect::Outside(Outsider::GainDrift { delta }) => Some(1.0 + delta * run_share),
        _ => None,
    };
    effects.iter().find_map(drift).unwrap_or(1.0)
}

/// Coefficient e of a sensor that reads v/√(1 + (e·v)²); 0 for a linear sensor.
fn compression(effects: &[Effect]) -> f64 {
    let sensor = |effect: &Effect| match effect {
        Effect::Outside(Outsider::SensorCompression { e }) => Some(*e),
        _ => None,
    };
    effects.iter().find_map(sensor).unwrap_or(0.0)
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

fn check(
    machine: &Machine,
    run_share: f64,
    omega_rad_s: f64,
    input: &[Complex],
) -> Result<(), SimulatorError> {
    let plant = &machine.plant;
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
    for (place, effect) in machine.effects.iter().enumerate() {
        effect.check()?;
        if machine.effects[..place].iter().any(|earlier| earlier.id() == effect.id()) {
            return Err(SimulatorError::Repeated { id: effect.id() });
        }
    }
    let has = |id: &str| machine.effects.iter().any(|effect| effect.id() == id);
    if has("backlash") && has("flexible_mode") {
        return Err(SimulatorError::TwoJoints);
    }
    let friction = &plant.friction;
    level("Fc+", friction.fc_plus, 0.0, "at least 0")?;
    level("Fc-", friction.fc_minus, 0.0, "at least 0")?;
    level("Fs+", friction.fs_plus, friction.fc_plus, "at least Fc+")?;
    level("Fs-", friction.fs_minus, friction.fc_minus, "at least Fc-")?;
    for effect in machine.effects {
        match *effect {
            Effect::StaticFriction { fs_plus, fs_minus } => {
                level("Fs+", fs_plus, friction.fc_plus, "at least Fc+")?;
                level("Fs-", fs_minus, friction.fc_minus, "at least Fc-")?;
            }
            Effect::Presliding { .. } => {
                positive("Fc+ of a bristle", friction.fc_plus)?;
                positive("Fc- of a bristle", friction.fc_minus)?;
            }
            _ => {}
        }
    }
    if !(0.0..=1.0).contains(&run_share) {
        let (quantity, requirement) = ("the share of the run", "from 0 to 1");
        return Err(SimulatorError::Unusable { quantity, value: run_share, requirement });
    }
    for value in input.iter().flat_map(|line| [line.re, line.im]) {
        level("a line of the input", value, f64::NEG_INFINITY, "a number")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
