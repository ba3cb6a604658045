//! A servo axis with every effect in place, as the simulation sees it.
//!
//! ```text
//!   u ─ delay ─ input maps ─ rate limit ─ A(s) ─ τ ─ mechanics ─ v ─ sensor lags ─ y
//!                                                    v' = −a v + K (τ − f − g)
//! ```
//!
//! An effect enters by setting one or more of these fields; what it leaves
//! alone is the base model's.

use crate::plant::{Friction, Plant, Scalar};

use super::law::Law;

/// Numbers while effects enter: derivatives along every parameter at once.
pub type Wide = crate::plant::Dual<WIDE_LANES>;

/// Most parameters, the plant's and the effects' together, one axis may have.
pub const WIDE_LANES: usize = 16;

/// Position of a map in the signal chain: lower numbers act first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Nearest to the command.
    DeadZone,
    /// Behind the dead zone.
    Gain,
    /// Behind the gain, ahead of the rate limit.
    Saturation,
}

/// A static, continuous, piecewise linear map of the input that keeps 0.
#[derive(Debug, Clone, PartialEq)]
pub struct InputMap<S> {
    /// Where it stands in the chain.
    pub stage: Stage,
    /// Where the slope changes, ascending, input units.
    pub breaks: Vec<S>,
    /// Slope of each piece: one more than there are breaks.
    pub slopes: Vec<S>,
}

impl<S: Scalar> InputMap<S> {
    /// Piece `i` as (offset, slope): its output is offset + slope·u.
    pub fn piece(&self, i: usize) -> (S, S) {
        // The piece that holds 0 has no offset; each break adds what the change
        // of slope there takes away.
        let home = self.breaks.iter().filter(|at| at.value() < 0.0).count();
        let mut offset = S::constant(0.0);
        for b in i.min(home)..i.max(home) {
            let step = (self.slopes[b] - self.slopes[b + 1]) * self.breaks[b];
            if i > home { offset += step } else { offset -= step }
        }
        (offset, self.slopes[i])
    }
}

/// A load behind a joint: motor and load share the inertia 1/K as (1 − ρ):ρ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondMass<S> {
    /// ρ: the load's share of the inertia, 0 to 1.
    pub load_inertia_fraction: S,
    /// k, input units per position unit.
    pub stiffness: S,
    /// c, input units per velocity unit.
    pub damping: S,
    /// Width of the play, position units; 0: none.
    pub gap: S,
}

/// An axis with every effect in place.
#[derive(Debug, Clone)]
pub struct Axis<S = f64> {
    /// The base model.
    pub plant: Plant<S>,
    /// α: the viscous rate is a(1 + α) forward and a(1 − α) backward.
    pub viscous_asymmetry: S,
    /// Factor on every friction level.
    pub friction_scale: S,
    /// Factor on the sliding friction as a function of v.
    pub friction_curve: Option<Law<S>>,
    /// σ of a bristle that takes the place of set-valued friction, input units
    /// per position unit.
    pub bristle: Option<S>,
    /// Further torques g(v, θ) against the motion.
    pub torques: Vec<Law<S>>,
    /// Whether a constant torque keeps the mean of v and of θ at zero.
    pub balanced: bool,
    /// A second mass.
    pub second_mass: Option<SecondMass<S>>,
    /// T of a pure delay, seconds.
    pub delay: S,
    /// Maps ahead of A(s).
    pub input_maps: Vec<InputMap<S>>,
    /// Limit of |w'| ahead of A(s), input units per second.
    pub rate_limit: Option<S>,
    /// Time constants of first-order lags of the sensor, seconds.
    pub sensor_lags: Vec<S>,
}

impl<S: Scalar> Axis<S> {
    /// The base model alone.
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

    /// The same axis with every number passed through `f`.
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

    /// The same axis with this share of every torque that ripples over θ.
    pub fn with_ripple(&self, share: f64) -> Self {
        let torques = self.torques.iter().map(|law| law.with_ripple(share)).collect();
        Self { torques, ..self.clone() }
    }

    /// Radians by which the fastest ripple turns for one unit of θ; 0 without one.
    pub fn ripple_rate(&self) -> f64 {
        self.torques.iter().map(Law::ripple_rate).fold(0.0, f64::max)
    }

    /// Adds a map in its place in the chain.
    pub fn add_input_map(&mut self, map: InputMap<S>) {
        self.input_maps.push(map);
        self.input_maps.sort_by_key(|map| map.stage);
    }

    /// Viscous rates forward and backward, rad/s.
    pub fn viscous_rates(&self) -> [S; 2] {
        let (a, alpha) = (self.plant.viscous_rate_rad_s, self.viscous_asymmetry);
        [a * (alpha + 1.0), a * (-alpha + 1.0)]
    }

    /// Friction levels with everything that scales them: Fc at large |v|, Fs at
    /// rest, where a curve may exceed what was given.
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

    /// Whether nothing ahead of A(s) bends the input.
    pub fn has_linear_input(&self) -> bool {
        self.input_maps.is_empty() && self.rate_limit.is_none()
    }

    /// Whether the mechanics are those of one mass with friction levels and
    /// viscous rates that depend on the direction alone.
    pub fn is_piecewise_linear(&self) -> bool {
        self.friction_curve.is_none()
            && self.bristle.is_none()
            && self.torques.is_empty()
            && !self.balanced
            && self.second_mass.is_none()
    }

    /// Whether damping is the same in both directions.
    pub fn damps_alike(&self) -> bool {
        // A number that may vary counts, even where it is zero at the moment.
        let alpha = self.viscous_asymmetry;
        alpha.value() == 0.0 && (0..S::LANES).all(|lane| alpha.lane(lane) == 0.0)
    }

    /// Whether the base model's own solution holds, sensor and delay aside.
    pub fn is_base(&self) -> bool {
        self.has_linear_input() && self.is_piecewise_linear() && self.damps_alike()
    }
}
