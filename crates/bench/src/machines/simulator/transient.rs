//! A single motion under a sampled input, from a given initial state.

use super::chain::Command;
use super::drive::Drive;
use super::effect::Effect;
use super::mechanics::{Mechanics, VELOCITY};
use super::stepping::{Axis, Piece};
use super::{Machine, Settings, SimulatorError, actuator_rate_rad_s, check, compression, gain};
use crate::measurement::Complex;

/// An equally sampled input; before the first sample it is constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Samples<'a> {
    /// Step, s.
    pub step_s: f64,
    /// Samples, input units.
    pub values: &'a [f64],
    /// Whether each sample is held until the next; otherwise the input is linear in between.
    pub hold: bool,
}

/// Initial state of a motion. A joint starts without twist, and a bristle unbent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Start {
    /// v of motor and load, response units.
    pub velocity: f64,
    /// θ.
    pub position: f64,
    /// τ and τ' behind the actuator. If not given, τ is the command at the first sample, and τ' =
    /// 0.
    pub torque: Option<[f64; 2]>,
    /// Constant torque that accompanies a cogging torque, input units.
    pub constant_torque: f64,
}

/// A motion at the times of the samples, as the sensor reports it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// v, response units.
    pub velocity: Vec<f64>,
    /// θ, with the initial position at the first sample.
    pub position: Vec<f64>,
    /// v'; at a jump, its value before the jump.
    pub acceleration: Vec<f64>,
}

/// Follows a motion from its start to the last sample.
///
/// # Errors
/// See [`SimulatorError`].
pub fn follow(
    machine: &Machine,
    run_share: f64,
    samples: &Samples,
    start: &Start,
    settings: &Settings,
) -> Result<Motion, SimulatorError> {
    let Machine { plant, effects } = machine;
    let lines: Vec<Complex> = samples.values.iter().map(|u| Complex::new(*u, 0.0)).collect();
    check(machine, run_share, 1.0 / samples.step_s, &lines)?;
    let factor = gain(effects, run_share);
    let values: Vec<f64> = samples.values.iter().map(|u| factor * u).collect();
    let command = Command::sampled_input(effects, samples.step_s, &values, samples.hold);
    let mechanics =
        Mechanics::of(plant, effects, run_share).with_cogging(start.constant_torque, 1.0);
    let largest = values.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let speed = largest * plant.constant / plant.viscous_rate_rad_s;
    let fastest = mechanics.fastest_rad_s(speed).max(actuator_rate_rad_s(&plant.actuator));
    let longest_step_s = samples.step_s.min(1.0 / (fastest * settings.steps_per_time_constant));
    let first_command = command.sampled(&command.stretches()[0], 2)[0];
    let torque = start.torque.unwrap_or([first_command, 0.0]);
    let drive = Drive::from_start(&plant.actuator, &command, longest_step_s, torque);
    let follow = match mechanics.states() {
        1 => motion::<1>,
        2 => motion::<2>,
        3 => motion::<3>,
        4 => motion::<4>,
        _ => motion::<5>,
    };
    Ok(follow(&mechanics, &drive, effects, samples, start))
}

fn motion<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    effects: &[Effect],
    samples: &Samples,
    start: &Start,
) -> Motion {
    let mut state = [0.0; N];
    state[VELOCITY] = start.velocity;
    if let Some(position) = mechanics.position() {
        state[position] = start.position;
    }
    if let Some(twist) = mechanics.twist() {
        state[twist + 1] = start.velocity;
    }
    let lag = effects.iter().find_map(|effect| match effect {
        Effect::SensorLag { time_constant } => Some(*time_constant),
        _ => None,
    });
    let compression = compression(effects);
    let mut sensor = Sensor { lag, reading: start.velocity, position: start.position };
    let mut motion = Motion::default();
    let mut add = |velocity: f64, position: f64, acceleration: f64| {
        motion.velocity.push(velocity / (1.0 + (compression * velocity).powi(2)).sqrt());
        motion.position.push(position);
        motion.acceleration.push(acceleration);
    };
    let mut count = 0;
    Axis::new(mechanics, drive, state).run_period(&mut |piece: &Piece<N>| {
        if count == 0 {
            let slope = lag.map_or(piece.start_slope[VELOCITY], |_| 0.0);
            add(start.velocity, start.position, slope);
            count = 1;
        }
        sensor.pass(piece);
        let due_s = count as f64 * samples.step_s;
        if piece.to_s >= due_s - 1e-7 * samples.step_s && count < samples.values.len() {
            let slope = match lag {
                Some(lag) => (piece.end[VELOCITY] - sensor.reading) / lag,
                None => piece.end_slope[VELOCITY],
            };
            add(sensor.reading, sensor.position, slope);
            count += 1;
        }
    });
    motion
}

/// A sensor with the lag y' = (v − y)/T, or none; integrates y and its position ∫y dt.
struct Sensor {
    lag: Option<f64>,
    reading: f64,
    position: f64,
}

impl Sensor {
    fn pass<const N: usize>(&mut self, piece: &Piece<N>) {
        let Some(lag) = self.lag else {
            self.position += piece.integral(VELOCITY);
            self.reading = piece.end[VELOCITY];
            return;
        };
        let length_s = piece.to_s - piece.from_s;
        let (first, last) = (piece.start[VELOCITY], piece.end[VELOCITY]);
        let slope = |v: f64, y: f64| (v - y) / lag;
        let middle = piece.middle(VELOCITY);
        let k1 = slope(first, self.reading);
        let k2 = slope(middle, self.reading + 0.5 * length_s * k1);
        let k3 = slope(middle, self.reading + 0.5 * length_s * k2);
        let k4 = slope(last, self.reading + length_s * k3);
        let before = self.reading;
        self.reading += length_s / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        // From y = v − T·y', ∫y dt = ∫v dt − T·Δy.
        self.position += piece.integral(VELOCITY) - lag * (self.reading - before);
    }
}
