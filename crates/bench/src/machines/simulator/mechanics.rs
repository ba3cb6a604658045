//! Equations of motion behind the actuator.
//!
//! ```text
//!   v'      = −a(v) v + K (τ + b − f − g(θ, v) − Tₛ)/(1−ρ)     b: constant torque
//!   θ'      = v
//!   z'      = v − |v| σ z/Fc(sgn v), f = σ z                    with a bristle
//!   φ'      = v − v_load                                        with a joint
//!   v_load' = K Tₛ/ρ
//! ```
//!
//! The viscous term acts on the motor, so a(v) here is the plant's a divided by 1−ρ. Without a
//! joint ρ = Tₛ = 0. Only the states that a machine has are integrated; N is their number.

mod joint;
mod switching;

use super::effect::Effect;
use super::friction::DryFriction;
use super::outsider::{OutsideMechanics, Outsider};
use crate::plant::Plant;
pub(super) use joint::Contact;
use joint::Joint;

/// Index of v, response units: the first state of every machine.
pub(super) const VELOCITY: usize = 0;

/// State of the friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Motion {
    /// The axis sticks at v = 0.
    Stuck,
    /// The axis slides in this direction, +1 or −1; v may still be 0.
    Sliding(f64),
}

/// Selects the equations of motion that apply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mode {
    pub(super) motion: Motion,
    pub(super) contact: Contact,
}

/// The cogging torque T·sin(N·θ + φ).
#[derive(Debug, Clone, Copy)]
struct Cogging {
    amplitude: f64,
    cycles_per_unit: f64,
    phase: f64,
}

/// Everything behind the actuator.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mechanics {
    /// a/(1−ρ) for v > 0 and for v < 0.
    viscous_rate_rad_s: [f64; 2],
    /// K/(1−ρ).
    constant: f64,
    /// K.
    whole_constant: f64,
    friction: DryFriction,
    drag: f64,
    stiffness: f64,
    cubic_stiffness: f64,
    cogging: Option<Cogging>,
    joint: Option<Joint>,
    /// b, input units.
    constant_torque: f64,
    outside: Option<OutsideMechanics>,
    /// Index of the state θ.
    position: Option<usize>,
    /// Index of the state z, and σ.
    bristle: Option<(usize, f64)>,
    states: usize,
}

impl Mechanics {
    pub(super) fn of(plant: &Plant, effects: &[Effect], run_share: f64) -> Self {
        let friction = DryFriction::of(&plant.friction, effects, run_share);
        let (mut alpha, mut drag) = (0.0, 0.0);
        let (mut stiffness, mut cubic_stiffness) = (0.0, 0.0);
        let (mut cogging, mut joint, mut has_position) = (None, None, false);
        let mut viscous_factor = 1.0;
        for effect in effects {
            match *effect {
                Effect::ViscousAsymmetry { alpha: asymmetry } => alpha = asymmetry,
                Effect::QuadraticDrag { c } => drag = c,
                Effect::Spring { stiffness: k } => {
                    stiffness += k;
                    has_position = true;
                }
                Effect::HardeningSpring { stiffness: k, cubic_stiffness: k3 } => {
                    stiffness += k;
                    cubic_stiffness = k3;
                    has_position = true;
                }
                Effect::Cogging { amplitude, cycles_per_unit, phase } => {
                    cogging = Some(Cogging { amplitude, cycles_per_unit, phase });
                    has_position = true;
                }
                Effect::Backlash { load_inertia_fraction, stiffness, damping, gap } => {
                    joint = Some((load_inertia_fraction, stiffness, damping, 0.5 * gap));
                }
                Effect::FlexibleMode { load_inertia_fraction, stiffness, damping } => {
                    joint = Some((load_inertia_fraction, stiffness, damping, 0.0));
                }
                Effect::Outside(Outsider::ViscousDrift { delta }) => {
                    viscous_factor = 1.0 + delta * run_share;
                }
                _ => {}
            }
        }
        let mut states = 1;
        let mut place = |count| {
            states += count;
            states - count
        };
        let position = has_position.then(|| place(1));
        let bristle = friction.bristle_stiffness.map(|sigma| (place(1), sigma));
        let joint = joint.map(|(load_fraction, stiffness, damping, half_gap)| Joint {
            load_fraction,
            stiffness,
            damping,
            half_gap,
            twist: place(2),
        });
        let motor_fraction = 1.0 - joint.map_or(0.0, |joint| joint.load_fraction);
        let a = viscous_factor * plant.viscous_rate_rad_s / motor_fraction;
        let outsiders = effects.iter().filter_map(|effect| match effect {
            Effect::Outside(outsider) => Some(*outsider),
            _ => None,
        });
        let outside = OutsideMechanics::of(outsiders, plant.viscous_rate_rad_s / plant.constant);
        Self {
            viscous_rate_rad_s: [a * (1.0 + alpha), a * (1.0 - alpha)],
            constant: plant.constant / motor_fraction,
            whole_constant: plant.constant,
            friction,
            drag,
            stiffness,
            cubic_stiffness,
            cogging,
            joint,
            constant_torque: 0.0,
            outside,
            position,
            bristle,
            states,
        }
    }

    /// Number of states.
    pub(super) fn states(&self) -> usize {
        self.states
    }

    /// Index of θ, if the machine has one.
    pub(super) fn position(&self) -> Option<usize> {
        self.position
    }

    /// Index of φ, if the machine has a joint; v_load is the next state.
    pub(super) fn twist(&self) -> Option<usize> {
        self.joint.map(|joint| joint.twist)
    }

    /// Width of the joint's gap; 0 without a joint.
    pub(super) fn gap(&self) -> f64 {
        self.joint.map_or(0.0, |joint| 2.0 * joint.half_gap)
    }

    /// A copy with another gap.
    pub(super) fn with_gap(&self, gap: f64) -> Self {
        let widened = |joint: Joint| Joint { half_gap: 0.5 * gap, ..joint };
        Self { joint: self.joint.map(widened), ..*self }
    }

    pub(super) fn friction(&self) -> &DryFriction {
        &self.friction
    }

    pub(super) fn has_cogging(&self) -> bool {
        self.cogging.is_some()
    }

    /// T, input units; 0 without cogging.
    pub(super) fn cogging_amplitude(&self) -> f64 {
        self.cogging.map_or(0.0, |cogging| cogging.amplitude)
    }

    /// A copy with the constant torque b and the given share of the cogging torque.
    pub(super) fn with_cogging(&self, constant_torque: f64, share: f64) -> Self {
        let scaled = |cogging: Cogging| Cogging { amplitude: share * cogging.amplitude, ..cogging };
        Self { constant_torque, cogging: self.cogging.map(scaled), ..*self }
    }

    /// The fastest rate that the steps have to resolve, rad/s, at speeds up to `speed`.
    pub(super) fn fastest_rad_s(&self, speed: f64) -> f64 {
        let level = self.friction.levels.fc_plus.max(self.friction.levels.fc_minus);
        let lowest = self.friction.levels.fc_plus.min(self.friction.levels.fc_minus);
        let mut fastest = self.viscous_rate_rad_s[0].max(self.viscous_rate_rad_s[1])
            + 2.0 * self.constant * self.drag * speed;
        if let Some(outside) = self.outside {
            fastest += self.constant * outside.steepest(speed);
        }
        let mut elastic =
            |stiffness: f64| fastest = fastest.max((self.constant * stiffness).sqrt());
        // The largest stiffness of a cubic spring is 3k₃θ² with θ = speed/rate, the travel during
        // its own time constant. With rate² = K·3k₃θ² that is speed·√(3k₃/K).
        elastic(self.stiffness + speed * (3.0 * self.cubic_stiffness / self.constant).sqrt());
        if let Some(Cogging { amplitude, cycles_per_unit, .. }) = self.cogging {
            elastic(amplitude * cycles_per_unit);
            fastest = fastest.max(cycles_per_unit * speed);
        }
        if let Some((excess, vs)) = self.friction.stribeck {
            fastest = fastest.max(self.constant * level * excess / vs);
        }
        if let Some((_, sigma)) = self.bristle {
            fastest = fastest.max((self.constant * sigma).sqrt());
            // A fully bent bristle relaxes at the rate σ·v/Fc. Its state is then constant, so
            // Runge–Kutta has to be stable only, which it is up to a rate of 2.8 per step.
            fastest = fastest.max(0.1 * sigma * speed / lowest);
        }
        if let Some(joint) = self.joint {
            let against_both = self.constant / joint.load_fraction;
            fastest = fastest
                .max((against_both * joint.stiffness).sqrt())
                .max(against_both * joint.damping);
        }
        fastest
    }

    /// τ + b − g − Tₛ without drag, input units: the torque that friction has to balance at rest.
    #[inline]
    fn net_torque<const N: usize>(&self, contact: Contact, torque: f64, state: &[f64; N]) -> f64 {
        if N == 1 {
            return torque;
        }
        let mut net = torque - self.joint_torque(contact, state);
        if let Some(position) = self.position {
            let theta = state[position];
            net -= theta * (self.stiffness + self.cubic_stiffness * theta * theta);
            if let Some(cogging) = self.cogging {
                let angle = cogging.cycles_per_unit * theta + cogging.phase;
                net += self.constant_torque - cogging.amplitude * angle.sin();
            }
        }
        net
    }

    /// Time derivative of the state.
    #[inline]
    pub(super) fn slope<const N: usize>(
        &self,
        mode: Mode,
        torque: f64,
        state: [f64; N],
    ) -> [f64; N] {
        let mut slope = [0.0; N];
        let v = state[VELOCITY];
        if let Motion::Sliding(direction) = mode.motion {
            let rate = self.viscous_rate_rad_s[usize::from(direction < 0.0)];
            let friction = match self.bristle {
                Some((bristle, sigma)) if N > 1 => {
                    let z = state[bristle];
                    slope[bristle] = self.friction.bristle_slope(sigma, direction, v, z);
                    sigma * z
                }
                _ => direction * self.friction.kinetic(direction, v),
            };
            let mut drag = direction * self.drag * v * v;
            let (mut torque, mut friction) = (torque, friction);
            if let Some(outside) = self.outside {
                drag += outside.drag(v);
                friction *= outside.friction_factor(torque);
                torque = outside.torque(torque, v);
            }
            let driving = self.net_torque(mode.contact, torque, &state) - friction - drag;
            slope[VELOCITY] = self.constant * driving - rate * v;
        }
        if N > 1
            && let Some(position) = self.position
        {
            slope[position] = v;
        }
        if N > 2
            && let Some(joint) = self.joint
        {
            let load = self.whole_constant / joint.load_fraction;
            slope[joint.twist] = v - state[joint.twist + 1];
            slope[joint.twist + 1] = load * self.joint_torque(mode.contact, &state);
        }
        slope
    }

    /// Tₛ, input units.
    #[inline]
    fn joint_torque<const N: usize>(&self, contact: Contact, state: &[f64; N]) -> f64 {
        match self.joint {
            Some(joint) if N > 2 => joint.torque(contact, state),
            _ => 0.0,
        }
    }
}
