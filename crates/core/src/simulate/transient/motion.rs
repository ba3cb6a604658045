//! What a transient begins with, and what it comes to.

use crate::measurement::Intersample;

/// An input at equal steps of time, from 0.
#[derive(Debug, Clone, Copy)]
pub struct SampledInput<'a> {
    /// Step, seconds.
    pub step_s: f64,
    /// Samples, input units. Before the first the input was as there.
    pub values: &'a [f64],
    /// What it does between them.
    pub between: Intersample,
}

/// Where a motion begins. What is `None` is as at a constant velocity under a constant input.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialState {
    /// v, velocity units; the load's, too, where there is one.
    pub velocity: f64,
    /// θ, position units: zero at a spring's rest.
    pub position: f64,
    /// τ behind an actuator of order 1 or 2, input units.
    pub torque: Option<f64>,
    /// τ' behind an actuator of order 2, input units per second.
    pub torque_rate: Option<f64>,
    /// How far the bristle is bent, −1 to 1 of as far as it goes.
    pub bristle: Option<f64>,
    /// Twist of the joint, position units.
    pub twist: Option<f64>,
    /// Constant torque beside one that ripples over θ, input units.
    pub balance: Option<f64>,
}

/// A motion at the samples' times, as the sensor reports it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// Velocity units.
    pub velocity: Vec<f64>,
    /// Position units, from [`InitialState::position`] on.
    pub position: Vec<f64>,
    /// Velocity units per second; where it jumps, what it was before.
    pub acceleration: Vec<f64>,
}

/// One quantity of a beginning.
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
    /// Its name for a person.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::Torque => "torque behind the actuator",
            Self::TorqueRate => "rate of the torque behind the actuator",
            Self::Bristle => "share to which the bristles are bent",
            Self::Twist => "twist of the joint",
            Self::Balance => "constant torque beside the ripple",
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
