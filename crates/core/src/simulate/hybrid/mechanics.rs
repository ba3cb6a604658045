//! Equations of motion in each mode, and the conditions under which the mode changes.

mod dynamics;
mod initial_state;

use crate::effects::{Axis, Law, SecondMass, TaylorSeries};
use crate::plant::Scalar;

use super::runge_kutta::Vector;
use crate::simulate::base::switching_times::Motion;

/// Most states of a motion: velocity, position, its integral, bristle, load and twist.
pub(super) const MOST_STATES: usize = 6;

/// Index of v in every state.
pub(super) const VELOCITY: usize = 0;

/// What the joint to a second mass does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contact {
    /// There is no gap, or no second mass.
    Linked,
    /// Inside the gap.
    Open,
    /// At its upper end, φ ≥ gap/2.
    Upper,
    /// At its lower end.
    Lower,
}

/// Share of its level up to which friction on bristles is taken to balance what
/// drives the axis, once their oscillation is left out.
const BALANCED: f64 = 0.9;

/// Which equations hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mode {
    pub motion: Motion,
    pub contact: Contact,
    /// Whether the bristle is bent as far as it goes, so that its force is constant until
    /// v turns.
    pub yields: bool,
}

/// A torque that is not linear, and where the state holds what it depends on.
struct Bent<S> {
    law: Law<S>,
    argument: usize,
}

/// The axis behind its actuator.
pub(super) struct Mechanics<S> {
    viscous_rate: [S; 2],
    constant: S,
    coulomb: [S; 2],
    breakaway: [S; 2],
    curve: Option<Law<S>>,
    bristle: Option<S>,
    /// Linear torques, and others.
    linear: Vec<Law<S>>,
    bent: Vec<Bent<S>>,
    second_mass: Option<SecondMass<S>>,
    /// Constant torque that keeps the mean of v zero.
    pub balance: S,
    /// Number of states.
    pub states: usize,
    /// Where θ stands in the state, and so on.
    pub position: Option<usize>,
    bristle_at: usize,
    pub load_velocity: usize,
    pub twist: usize,
    /// ∫θ dt, where the mean of θ matters.
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
        let (linear, bent): (Vec<_>, Vec<_>) =
            axis.torques.iter().partition(|law| law.form().is_linear());
        let of = |law: Law<S>| {
            let argument = if law.form().uses_position() { position } else { None };
            Bent { law, argument: argument.unwrap_or(VELOCITY) }
        };
        let bent = bent.into_iter().map(of).collect();
        Self {
            viscous_rate: axis.viscous_rates(),
            constant: axis.plant.constant,
            coulomb: [levels.fc_plus, -levels.fc_minus],
            breakaway: [levels.fs_plus, -levels.fs_minus],
            curve: axis.friction_curve,
            bristle: axis.bristle,
            linear,
            bent,
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

    /// Whether two motions under the same torque always approach each other.
    pub fn contracts(&self) -> bool {
        let play = self.second_mass.is_some_and(|mass| mass.gap.value() > 0.0);
        self.curve.is_none()
            && !play
            && self.coulomb.map(S::value) == self.breakaway.map(S::value)
            && self.torques().all(|law| law.form().contracts())
    }

    /// Size of an error of v that matters at velocity v: near zero a friction curve
    /// makes much of little.
    pub fn velocity_size(&self, velocity: f64, size: f64) -> f64 {
        match self.curve.as_ref().and_then(Law::velocity_scale) {
            Some(scale) => (velocity.abs() + scale).min(size),
            None => size,
        }
    }

    /// Whether the equations are affine between switches.
    pub fn is_affine(&self) -> bool {
        self.has_series() && self.bent.is_empty()
    }

    /// Whether the motion between switches is a power series whose terms are known.
    pub fn has_series(&self) -> bool {
        self.curve.is_none()
            && self.bristle.is_none()
            && self.bent.iter().all(|bent| bent.law.form().has_series())
    }

    fn torques(&self) -> impl Iterator<Item = &Law<S>> {
        self.linear.iter().chain(self.bent.iter().map(|bent| &bent.law))
    }

    /// What follows the torques that are not linear along a motion.
    pub fn jets(&self) -> Vec<TaylorSeries> {
        self.bent.iter().map(|bent| bent.law.jet()).collect()
    }

    /// The last term of the torques that are not linear along a motion of these terms.
    #[inline]
    pub fn bent_term<const M: usize>(
        &self,
        mode: Mode,
        jets: &mut [TaylorSeries],
        terms: &[Vector<S, M>],
    ) -> S {
        let direction = if mode.motion == Motion::Backward { -1.0 } else { 1.0 };
        let mut sum = S::constant(0.0);
        for (Bent { law, argument }, jet) in self.bent.iter().zip(jets) {
            jet.direction = direction;
            sum += law.term(jet, |m| terms[m][*argument], terms.len() - 1);
        }
        sum
    }

    /// The fastest rate at which the state changes between switches, where the
    /// equations are affine there.
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

    /// Whether no constant torque lets a torque of this range move the axis.
    pub fn rests_balanced(&self, (least, most): (f64, f64)) -> bool {
        let [forward, backward] = self.breakaway.map(S::value);
        most - least <= forward - backward
    }

    /// Whether no motion under a torque of this range lasts.
    ///
    /// With c between what the torque can exceed friction by forward (most − Fc⁺) and
    /// backward (least + Fc⁻), (τ − f)·v ≤ c·v, and v²/2K less c·θ and with the energy of
    /// what restores θ falls as −a·v²/K: v vanishes, be it that an axis creeps ever more
    /// slowly to where it sticks.
    pub fn comes_to_rest(&self, (least, most): (f64, f64)) -> bool {
        let (still, unit) = (S::constant(0.0), S::constant(1.0));
        let least_curve = self.curve.map_or(1.0, |curve| curve.at(still, still).value().min(1.0));
        let [forward, backward] = self.coulomb.map(|level| level.value() * least_curve);
        let restores = |law: &Law<S>| {
            law.form().uses_position() && law.at(still, unit).value() > law.at(still, still).value()
        };
        self.bristle.is_none() && self.torques().any(restores) && most - least <= forward - backward
    }

    /// A constant torque that balances what friction holds back on average.
    pub fn first_balance(&self) -> f64 {
        0.5 * (self.coulomb[0].value() + self.coulomb[1].value())
    }

    /// What the axis does in a state, where nothing says what it did before.
    pub fn mode_at<const M: usize>(&self, torque: S, state: &Vector<S, M>) -> Mode {
        let contact = match self.half_gap() {
            None => Contact::Linked,
            Some(half) => match state[self.twist].value() {
                twist if twist > half => Contact::Upper,
                twist if twist < -half => Contact::Lower,
                _ => Contact::Open,
            },
        };
        let motion = match state[VELOCITY].value() {
            v if v > 0.0 => Motion::Forward,
            v if v < 0.0 => Motion::Backward,
            _ => self.motion_at_rest(contact, torque, state),
        };
        Mode { motion, contact, yields: false }
    }

    /// What friction lets an axis do that has v = 0.
    pub fn motion_at_rest<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> Motion {
        let Some(sigma) = self.bristle else { return self.motion_held(contact, torque, state) };
        // A bristle holds nothing: it pulls one way or the other.
        let bent = sigma * state[self.bristle_at];
        match self.net(contact, torque, state).value() < bent.value() {
            true => Motion::Backward,
            false => Motion::Forward,
        }
    }

    /// Whether a bristle of constant friction is, within `tolerance`, bent as far as it goes
    /// and not known to be yet. What it lacks falls as exp(−σ/Fc·travel), however stiff it
    /// makes the equations.
    pub fn yields<const M: usize>(&self, mode: Mode, state: &Vector<S, M>, tolerance: f64) -> bool {
        let Some(sigma) = self.bristle.filter(|_| !mode.yields && self.curve.is_none()) else {
            return false;
        };
        let level = self.level(mode).value();
        (sigma.value() * state[self.bristle_at].value() - level).abs() < tolerance * level.abs()
    }

    /// Bends the bristle as far as it goes.
    pub fn bend<const M: usize>(&self, mode: Mode, state: &mut Vector<S, M>) {
        if let Some(sigma) = self.bristle {
            state[self.bristle_at] = self.level(mode) / sigma;
        }
    }

    /// Coulomb friction in the direction of motion, signed.
    fn level(&self, mode: Mode) -> S {
        self.coulomb[usize::from(mode.motion == Motion::Backward)]
    }

    /// Whether friction can hold the axis at all.
    pub fn can_rest(&self) -> bool {
        self.bristle.is_none()
    }

    /// gap/2, where there is a gap.
    pub fn half_gap(&self) -> Option<f64> {
        self.second_mass.map(|mass| 0.5 * mass.gap.value()).filter(|half| *half > 0.0)
    }

    /// gap/2 − φ at the upper end, gap/2 + φ at the lower: positive inside.
    pub fn clearance<const M: usize>(&self, upper: bool, state: &Vector<S, M>) -> S {
        let gap = self.second_mass.map_or(S::constant(0.0), |mass| mass.gap);
        let twist = state[self.twist];
        if upper { gap * 0.5 - twist } else { gap * 0.5 + twist }
    }

    /// What friction balances while the axis does not move: forward, backward.
    fn held(&self) -> [S; 2] {
        match self.bristle {
            Some(_) => self.coulomb.map(|level| level * BALANCED),
            None => self.breakaway,
        }
    }

    /// What an axis does that friction has held so far.
    pub fn motion_held<const M: usize>(
        &self,
        contact: Contact,
        torque: S,
        state: &Vector<S, M>,
    ) -> Motion {
        let net = self.net(contact, torque, state).value();
        match self.held().map(S::value) {
            [forward, _] if net > forward => Motion::Forward,
            [_, backward] if net < backward => Motion::Backward,
            _ => Motion::Stuck,
        }
    }

    /// Bends the bristles of an axis that they have held so far as they balance what
    /// drives it, and moves it as that changes at this rate: σ·v·(1 − σz/Fc) = τ'.
    pub fn set_off<const M: usize>(
        &self,
        mode: Mode,
        torque: S,
        torque_rate: S,
        state: &mut Vector<S, M>,
    ) {
        let Some(sigma) = self.bristle else { return };
        let net = self.net(mode.contact, torque, state);
        let level = self.coulomb[usize::from(mode.motion == Motion::Backward)];
        state[self.bristle_at] = net / sigma;
        state[VELOCITY] = torque_rate / (sigma * (-(net / level) + 1.0));
    }
}
