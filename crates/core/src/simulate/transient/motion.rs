//! Input, initial state and result of a transient simulation.

use crate::measurement::Intersample;

/// An input sampled at equal steps, from time 0.
#[derive(Debug, Clone, Copy)]
pub struct SampledInput<'a> {
    /// Step, seconds.
    pub step_s: f64,
    /// Samples, input units. Before the first sample the input had the same value as there.
    pub values: &'a [f64],
    /// Course of the input between the samples.
    pub between: Intersample,
}

/// Initial state of a motion. A quantity that is `None` has the value of a motion at constant
/// velocity under a constant input.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialState {
    /// v, velocity units; of the load too, if there is one.
    pub velocity: f64,
    /// θ, position units: zero where a spring is at rest.
    pub position: f64,
    /// τ behind an actuator of order 1 or 2, input units.
    pub torque: Option<f64>,
    /// τ' behind an actuator of order 2, input units per second.
    pub torque_rate: Option<f64>,
    /// Deflection of the bristle as a share of its largest deflection, −1 to 1.
    pub bristle: Option<f64>,
    /// Twist of the joint, position units.
    pub twist: Option<f64>,
    /// Constant torque that acts together with a torque that is periodic in θ, input units.
    pub balance: Option<f64>,
}

/// A motion as the sensor reports it, at the times of the input's samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// Velocity units.
    pub velocity: Vec<f64>,
    /// Position units, from [`InitialState::position`] on.
    pub position: Vec<f64>,
    /// Velocity units per second; at a jump, the value before it.
    pub acceleration: Vec<f64>,
}

/// A quantity of an initial state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// [`InitialState::velocity`].
    Velocity,
    /// [`InitialState::position`].
    Position,
    /// [`InitialState::torque`].
    Torque,
    /// [`InitialState::torque_rate`].
    TorqueRate,
    /// [`InitialState::bristle`].
    Bristle,
    /// [`InitialState::twist`].
    Twist,
    /// [`InitialState::balance`].
    Balance,
}

impl Quantity {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::Torque => "output of the actuator",
            Self::TorqueRate => "rate of the output of the actuator",
            Self::Bristle => "share to which the bristles are bent",
            Self::Twist => "twist of the joint",
            Self::Balance => "constant load beside the ripple",
        }
    }
}

impl InitialState {
    /// Sets one quantity.
    pub fn set(&mut self, quantity: Quantity, value: f64) {
        match quantity {
            Quantity::Velocity => self.velocity = value,
            Quantity::Position => self.position = value,
            Quantity::Torque => self.torque = Some(value),
            Quantity::TorqueRate => self.torque_rate = Some(value),
            Quantity::Bristle => self.bristle = Some(value.clamp(-1.0, 1.0)),
            Quantity::Twist => self.twist = Some(value),
            Quantity::Balance => self.balance = Some(value),
        }
    }
}
