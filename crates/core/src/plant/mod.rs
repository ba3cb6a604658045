//! The base model of a servo axis: actuator, mechanics and dry friction.
//!
//! ```text
//!   τ  = A(s) u                     actuator, unit DC gain, order 0, 1 or 2
//!   v' = −a v + K (τ − f)           mechanics from torque to velocity
//! ```
//!
//! u is the input, τ the torque behind the actuator, v the velocity and f the dry friction. All
//! torques and friction levels are in input units. [`Scalar`] lets the same formulas carry
//! derivatives.

mod scalar;

pub use scalar::{Dual, Scalar};

use crate::measurement::Complex;

/// The actuator A(s), with unit DC gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Actuator<S = f64> {
    /// A = 1.
    Direct,
    /// A = p/(s + p).
    FirstOrder {
        /// Corner frequency p, rad/s.
        corner_rad_s: S,
    },
    /// A = ωₙ²/(s² + 2ζωₙ s + ωₙ²).
    SecondOrder {
        /// Natural frequency ωₙ, rad/s.
        natural_frequency_rad_s: S,
        /// Damping ratio ζ.
        damping_ratio: S,
    },
}

impl<S: Copy> Actuator<S> {
    /// Converts every number of the actuator with `f`.
    pub fn map<T>(&self, mut f: impl FnMut(S) -> T) -> Actuator<T> {
        match *self {
            Actuator::Direct => Actuator::Direct,
            Actuator::FirstOrder { corner_rad_s } => {
                Actuator::FirstOrder { corner_rad_s: f(corner_rad_s) }
            }
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                Actuator::SecondOrder {
                    natural_frequency_rad_s: f(natural_frequency_rad_s),
                    damping_ratio: f(damping_ratio),
                }
            }
        }
    }
}

impl Actuator {
    /// Order of A(s).
    pub fn order(&self) -> u8 {
        match self {
            Actuator::Direct => 0,
            Actuator::FirstOrder { .. } => 1,
            Actuator::SecondOrder { .. } => 2,
        }
    }

    /// A(jω).
    pub fn response(&self, omega_rad_s: f64) -> Complex {
        match *self {
            Actuator::Direct => Complex::new(1.0, 0.0),
            Actuator::FirstOrder { corner_rad_s: p } => p / Complex::new(p, omega_rad_s),
            Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
                wn * wn
                    / Complex::new(
                        wn * wn - omega_rad_s * omega_rad_s,
                        2.0 * zeta * wn * omega_rad_s,
                    )
            }
        }
    }
}

/// Levels of the dry friction f, input units, all ≥ 0.
///
/// v > 0: f = Fc⁺; v < 0: f = −Fc⁻; v = 0: f takes the value in [−Fs⁻, +Fs⁺] that keeps the axis at
/// rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction<S = f64> {
    /// Fc⁺: Coulomb level while v > 0.
    pub fc_plus: S,
    /// Fc⁻: Coulomb level while v < 0.
    pub fc_minus: S,
    /// Fs⁺ ≥ Fc⁺: static level, which the torque must exceed to start a forward motion.
    pub fs_plus: S,
    /// Fs⁻ ≥ Fc⁻: static level of a backward motion.
    pub fs_minus: S,
}

impl<S: Copy> Friction<S> {
    /// Friction whose static levels equal its Coulomb levels.
    pub fn coulomb(fc_plus: S, fc_minus: S) -> Self {
        Self { fc_plus, fc_minus, fs_plus: fc_plus, fs_minus: fc_minus }
    }
}

/// A servo axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant<S = f64> {
    /// Viscous rate a, 1/s: the mechanics' pole is −a.
    pub viscous_rate_rad_s: S,
    /// Constant K, response units per input unit and second.
    pub constant: S,
    /// A(s).
    pub actuator: Actuator<S>,
    /// Dry friction.
    pub friction: Friction<S>,
}

impl<S: Scalar> Plant<S> {
    /// Converts every number of the plant with `f`, in the order a, K, actuator, friction.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Plant<T> {
        Plant {
            viscous_rate_rad_s: f(self.viscous_rate_rad_s),
            constant: f(self.constant),
            actuator: self.actuator.map(&mut f),
            friction: Friction {
                fc_plus: f(self.friction.fc_plus),
                fc_minus: f(self.friction.fc_minus),
                fs_plus: f(self.friction.fs_plus),
                fs_minus: f(self.friction.fs_minus),
            },
        }
    }
}

impl Plant {
    /// P(jω) = K/(jω + a).
    pub fn mechanics_response(&self, omega_rad_s: f64) -> Complex {
        self.constant / Complex::new(self.viscous_rate_rad_s, omega_rad_s)
    }
}
