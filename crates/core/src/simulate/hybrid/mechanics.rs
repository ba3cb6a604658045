//! The mechanics behind the actuator: its parameters, its states, and properties of its motion.
//!
//! The equations of motion are in `dynamics`, the modes in which they differ in `mode`, the events
//! that end a mode in `events`.

mod bristles;
mod dynamics;
mod events;
mod initial_state;
mod mode;
mod nonlinear_torques;

use crate::effects::{Axis, Law, SecondMass};
use crate::plant::Scalar;

use super::runge_kutta::Vector;
use crate::simulate::base::switching_times::Motion;
pub(super) use events::Event;
pub(super) use mode::{Contact, Mode};
use nonlinear_torques::NonlinearTorque;

pub(super) use crate::simulate::last_motion::MOST_STATES;

/// Index of v in every state vector.
pub(super) const VELOCITY: usize = 0;

/// The mechanics of an axis. Arrays of two hold the values forward and backward; levels are signed.
pub(super) struct Mechanics<S> {
    viscous_rate: [S; 2],
    constant: S,
    coulomb: [S; 2],
    breakaway: [S; 2],
    curve: Option<Law<S>>,
    bristle: Option<S>,
    /// Torques that are linear in v and θ.
    linear: Vec<Law<S>>,
    nonlinear: Vec<NonlinearTorque<S>>,
    second_mass: Option<SecondMass<S>>,
    /// Constant torque that keeps the mean of v zero.
    pub balance: S,
    /// Number of states.
    pub states: usize,
    /// Index of θ in the state vector; the following are indices too.
    pub position: Option<usize>,
    bristle_at: usize,
    pub load_velocity: usize,
    pub twist: usize,
    /// ∫θ dt, if the mean of θ must be zero.
    pub position_integral: Option<usize>,
}

impl<S: Scalar> Mechanics<S> {
    pub fn new(axis: &Axis<S>) -> Self {
        let levels = axis.levels();
        let mut states = 1;
        let mut next = || {
            states += 1;
            states - 1
        };
        let uses_position =
            axis.balanced || axis.torques.iter().any(|law| law.form().uses_position());
        let position = uses_position.then(&mut next);
        let bristle_at = if axis.bristle.is_some() { next() } else { 0 };
        let (load_velocity, twist) =
            if axis.second_mass.is_some() { (next(), next()) } else { (0, 0) };
        let position_integral = axis.balanced.then(&mut next);
        let (linear, nonlinear): (Vec<_>, Vec<_>) =
            axis.torques.iter().partition(|law| law.form().is_linear());
        let of = |law: Law<S>| {
            let argument = if law.form().uses_position() { position } else { None };
            NonlinearTorque { law, argument: argument.unwrap_or(VELOCITY) }
        };
        let nonlinear = nonlinear.into_iter().map(of).collect();
        Self {
            viscous_rate: axis.viscous_rates(),
            constant: axis.plant.constant,
            coulomb: [levels.fc_plus, -levels.fc_minus],
            breakaway: [levels.fs_plus, -levels.fs_minus],
            curve: axis.friction_curve,
            bristle: axis.bristle,
            linear,
            nonlinear,
            second_mass: axis.second_mass,
            balance: S::constant(0.0),
            states,
            position,
            bristle_at,
            load_velocity,
            twist,
            position_integral,
        }
    }

    /// Whether any two motions under the same torque approach each other: the periodic one is
    /// unique.
    pub fn contracts(&self) -> bool {
        let play = self.second_mass.is_some_and(|mass| mass.gap.value() > 0.0);
        self.curve.is_none()
            && !play
            && self.coulomb.map(S::value) == self.breakaway.map(S::value)
            && self.torques().all(|law| law.form().contracts())
    }

    /// Size of v that an error of v is compared with at this velocity. Near zero a friction curve
    /// is steep and the size is small.
    pub fn velocity_size(&self, velocity: f64, size: f64) -> f64 {
        match self.curve.as_ref().and_then(Law::velocity_scale) {
            Some(scale) => (velocity.abs() + scale).min(size),
            None => size,
        }
    }

    /// Whether the equations are affine between switches.
    pub fn is_affine(&self) -> bool {
        self.has_series() && self.nonlinear.is_empty()
    }

    /// Whether the Taylor series of the motion between switches can be computed.
    pub fn has_series(&self) -> bool {
        self.curve.is_none()
            && self.bristle.is_none()
            && self.nonlinear.iter().all(|nonlinear| nonlinear.law.form().has_series())
    }

    fn torques(&self) -> impl Iterator<Item = &Law<S>> {
        self.linear.iter().chain(self.nonlinear.iter().map(|nonlinear| &nonlinear.law))
    }

    /// An upper estimate of the fastest rate of the motion between switches, rad/s, from the linear
    /// torques alone.
    pub fn fastest_rate(&self) -> f64 {
        let constant = self.constant.value().abs();
        let mut inverse_inertia = constant;
        let mut damping = self.viscous_rate[0].value().max(self.viscous_rate[1].value());
        let mut stiffness = 0.0;
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        for law in &self.linear {
            stiffness += law.at(zero, one).value().abs();
            damping += constant * law.at(one, zero).value().abs();
        }
        if let Some(mass) = self.second_mass {
            let share = mass.load_inertia_fraction.value();
            inverse_inertia /= share * (1.0 - share);
            damping = damping / (1.0 - share) + inverse_inertia * mass.damping.value();
            stiffness += mass.stiffness.value();
        }
        damping.max((inverse_inertia * stiffness).sqrt())
    }

    /// Whether a torque of this range, plus a suitable constant torque, cannot move the axis.
    pub fn rests_balanced(&self, (least, most): (f64, f64)) -> bool {
        let [forward, backward] = self.breakaway.map(S::value);
        most - least <= forward - backward
    }

    /// Whether every motion of an axis with a spring dies out under a torque of this range.
    ///
    /// The condition is most − Fc⁺ ≤ least + Fc⁻. Let c lie between the two; then (τ − f)·v ≤ c·v
    /// in both directions. With E(θ) the energy of the spring, v²/2K + E(θ) − c·θ changes at a rate
    /// of at most −a·v²/K. Hence v vanishes, though the axis may creep ever more slowly to where it
    /// sticks.
    pub fn comes_to_rest(&self, (least, most): (f64, f64)) -> bool {
        let (still, unit) = (S::constant(0.0), S::constant(1.0));
        let least_curve = self.curve.map_or(1.0, |curve| curve.at(still, still).value().min(1.0));
        let [forward, backward] = self.coulomb.map(|level| level.value() * least_curve);
        let restores = |law: &Law<S>| {
            law.form().uses_position() && law.at(still, unit).value() > law.at(still, still).value()
        };
        self.bristle.is_none() && self.torques().any(restores) && most - least <= forward - backward
    }

    /// First guess of [`Self::balance`]: the mean of the signed friction levels forward and
    /// backward.
    pub fn first_balance(&self) -> f64 {
        0.5 * (self.coulomb[0].value() + self.coulomb[1].value())
    }

    /// Coulomb friction in the direction of motion, signed.
    fn level(&self, mode: Mode) -> S {
        self.coulomb[usize::from(mode.motion == Motion::Backward)]
    }

    /// Whether friction can hold the axis at rest: not if it acts through a bristle.
    pub fn can_rest(&self) -> bool {
        self.bristle.is_none()
    }

    /// gap/2; `None` without a gap.
    pub fn half_gap(&self) -> Option<f64> {
        self.second_mass.map(|mass| 0.5 * mass.gap.value()).filter(|half| *half > 0.0)
    }

    /// Distance to an end of the gap, gap/2 − φ (upper) or gap/2 + φ (lower): positive inside.
    pub fn clearance<const M: usize>(&self, upper: bool, state: &Vector<S, M>) -> S {
        let gap = self.second_mass.map_or(S::constant(0.0), |mass| mass.gap);
        let twist = state[self.twist];
        if upper { gap * 0.5 - twist } else { gap * 0.5 + twist }
    }
}
