//! A servo axis with all its effects, in the form that the simulation reads.
//!
//! ```text
//!   u ─ delay ─ input maps ─ rate limit ─ A(s) ─ τ ─ mechanics ─ v ─ sensor lags ─ y
//!                                                    v' = −a v + K (τ − f − g)
//! ```
//!
//! Each effect sets one or more fields of [`Axis`]; the others keep the values of the base model.

use crate::plant::{Friction, Plant, Scalar};

use super::law::Law;

/// The number type in which effects enter: a dual number with a lane for every parameter.
pub type Wide = crate::plant::Dual<WIDE_LANES>;

/// Largest number of parameters of one axis: the plant's and the effects' together.
pub const WIDE_LANES: usize = 16;

/// Position of an input map in the signal chain; maps act in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Acts first.
    DeadZone,
    /// Acts after the dead zone.
    Gain,
    /// Acts after the gain, before the rate limit.
    Saturation,
}

/// A static, continuous, piecewise linear map of the input that maps 0 to 0.
#[derive(Debug, Clone, PartialEq)]
pub struct InputMap<S> {
    /// Its position in the chain.
    pub stage: Stage,
    /// Inputs at which the slope changes, ascending, input units.
    pub breaks: Vec<S>,
    /// Slope of each piece: one more than there are breaks.
    pub slopes: Vec<S>,
}

impl<S: Scalar> InputMap<S> {
    /// (offset, slope) of piece `i`: the output is offset + slope·u.
    pub fn piece(&self, i: usize) -> (S, S) {
        // The piece that contains 0 has offset 0. At a break b, continuity changes the offset by
        // (slope below − slope above)·b.
        let zero_piece = self.breaks.iter().filter(|at| at.value() < 0.0).count();
        let mut offset = S::constant(0.0);
        for b in i.min(zero_piece)..i.max(zero_piece) {
            let step = (self.slopes[b] - self.slopes[b + 1]) * self.breaks[b];
            if i > zero_piece { offset += step } else { offset -= step }
        }
        (offset, self.slopes[i])
    }
}

/// A load behind a joint. Motor and load split the inertia 1/K as (1 − ρ):ρ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondMass<S> {
    /// ρ: the load's share of the inertia, 0 to 1.
    pub load_inertia_fraction: S,
    /// k, input units per position unit.
    pub stiffness: S,
    /// c, input units per velocity unit.
    pub damping: S,
    /// Width of the gap in the joint, position units; 0 if there is none.
    pub gap: S,
}

/// An axis with all its effects.
#[derive(Debug, Clone)]
pub struct Axis<S = f64> {
    /// The base model.
    pub plant: Plant<S>,
    /// α: the viscous rate is a(1 + α) forward and a(1 − α) backward.
    pub viscous_asymmetry: S,
    /// Factor on all friction levels, Fc and Fs.
    pub friction_scale: S,
    /// Factor on the Coulomb friction, as a function of v.
    pub friction_curve: Option<Law<S>>,
    /// σ, input units per position unit, of the Dahl bristle that replaces set-valued friction.
    pub bristle: Option<S>,
    /// Terms of g(v, θ), the torques subtracted from τ.
    pub torques: Vec<Law<S>>,
    /// Whether a constant torque makes the mean of v zero, and θ has zero mean.
    pub balanced: bool,
    /// The load behind a joint, if there is one.
    pub second_mass: Option<SecondMass<S>>,
    /// Transport delay of the input, seconds.
    pub delay: S,
    /// Input maps ahead of A(s), in the order in which they act.
    pub input_maps: Vec<InputMap<S>>,
    /// Limit of |w'|, where w is the input of A(s), input units per second.
    pub rate_limit: Option<S>,
    /// Time constants of first-order lags of the sensor, seconds.
    pub sensor_lags: Vec<S>,
}

impl<S: Scalar> Axis<S> {
    /// The base model without effects.
    pub fn base(plant: Plant<S>) -> Self {
        Self {
            plant,
            viscous_asymmetry: S::constant(0.0),
            friction_scale: S::constant(1.0),
            friction_curve: None,
            bristle: None,
            torques: Vec::new(),
            balanced: false,
            second_mass: None,
            delay: S::constant(0.0),
            input_maps: Vec::new(),
            rate_limit: None,
            sensor_lags: Vec::new(),
        }
    }

    /// Converts every number of the axis with `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T + Copy) -> Axis<T> {
        let all = |values: &[S]| values.iter().copied().map(f).collect();
        Axis {
            plant: self.plant.map(f),
            viscous_asymmetry: f(self.viscous_asymmetry),
            friction_scale: f(self.friction_scale),
            friction_curve: self.friction_curve.map(|law| law.map(f)),
            bristle: self.bristle.map(f),
            torques: self.torques.iter().map(|law| law.map(f)).collect(),
            balanced: self.balanced,
            second_mass: self.second_mass.map(|mass| SecondMass {
                load_inertia_fraction: f(mass.load_inertia_fraction),
                stiffness: f(mass.stiffness),
                damping: f(mass.damping),
                gap: f(mass.gap),
            }),
            delay: f(self.delay),
            input_maps: self
                .input_maps
                .iter()
                .map(|map| InputMap {
                    stage: map.stage,
                    breaks: all(&map.breaks),
                    slopes: all(&map.slopes),
                })
                .collect(),
            rate_limit: self.rate_limit.map(f),
            sensor_lags: all(&self.sensor_lags),
        }
    }

    /// The same axis with the amplitude of every torque sinusoidal in θ multiplied by `share`.
    pub fn with_ripple(&self, share: f64) -> Self {
        let torques = self.torques.iter().map(|law| law.with_ripple(share)).collect();
        Self { torques, ..self.clone() }
    }

    /// Largest spatial frequency of the torques sinusoidal in θ, rad per unit of θ; 0 without one.
    pub fn ripple_rate(&self) -> f64 {
        self.torques.iter().map(Law::ripple_rate).fold(0.0, f64::max)
    }

    /// Adds a map at its position in the chain.
    pub fn add_input_map(&mut self, map: InputMap<S>) {
        self.input_maps.push(map);
        self.input_maps.sort_by_key(|map| map.stage);
    }

    /// Viscous rates forward and backward, rad/s.
    pub fn viscous_rates(&self) -> [S; 2] {
        let (a, alpha) = (self.plant.viscous_rate_rad_s, self.viscous_asymmetry);
        [a * (alpha + 1.0), a * (-alpha + 1.0)]
    }

    /// Friction levels with all factors applied. Fc is the level at large |v|. Fs is the larger of
    /// the given static level and Fc times the friction curve at rest.
    pub fn levels(&self) -> Friction<S> {
        let friction = self.plant.friction;
        let zero = S::constant(0.0);
        let at_rest = match &self.friction_curve {
            Some(curve) => curve.at(zero, zero),
            None => S::constant(1.0),
        };
        let larger = |a: S, b: S| if a.value() >= b.value() { a } else { b };
        let scale = self.friction_scale;
        let level = |fc: S, fs: S| (fc * scale, larger(fs, fc * at_rest) * scale);
        let (fc_plus, fs_plus) = level(friction.fc_plus, friction.fs_plus);
        let (fc_minus, fs_minus) = level(friction.fc_minus, friction.fs_minus);
        Friction { fc_plus, fc_minus, fs_plus, fs_minus }
    }

    /// Whether the chain ahead of A(s) is linear.
    pub fn has_linear_input(&self) -> bool {
        self.input_maps.is_empty() && self.rate_limit.is_none()
    }

    /// Whether the mechanics are one mass whose friction levels and viscous rates depend only on
    /// the direction of motion.
    pub fn is_piecewise_linear(&self) -> bool {
        self.friction_curve.is_none()
            && self.bristle.is_none()
            && self.torques.is_empty()
            && !self.balanced
            && self.second_mass.is_none()
    }

    /// Whether the viscous rate is the same in both directions.
    pub fn damps_alike(&self) -> bool {
        // α with a derivative is a free parameter, which counts even at the value 0.
        let alpha = self.viscous_asymmetry;
        alpha.value() == 0.0 && (0..S::LANES).all(|lane| alpha.lane(lane) == 0.0)
    }

    /// Whether the base model's solver applies; it allows any delay, sensor lag and friction level.
    pub fn is_base(&self) -> bool {
        self.has_linear_input() && self.is_piecewise_linear() && self.damps_alike()
    }
}
