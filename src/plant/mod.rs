//! The base model of a servo axis: actuator, mechanics and dry friction.
//!
//! ```text
//!   τ  = A(s) u                     actuator, unit DC gain, order 0, 1 or 2
//!   v' = −a v + K (τ − f)           mechanics from torque to velocity
//! ```
//!
//! All torques and friction levels are in input units.

use crate::measurement::Complex;

/// The actuator A(s), unit DC gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Actuator {
    /// A = 1.
    Direct,
    /// A = p/(s + p).
    FirstOrder {
        /// p, rad/s.
        corner_rad_s: f64,
    },
    /// A = ωₙ²/(s² + 2ζωₙ s + ωₙ²).
    SecondOrder {
        /// ωₙ, rad/s.
        natural_frequency_rad_s: f64,
        /// ζ.
        damping_ratio: f64,
    },
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

/// Levels of dry friction, input units, all ≥ 0.
///
/// v > 0: f = Fc⁺; v < 0: f = −Fc⁻; v = 0: whatever value in [−Fs⁻, +Fs⁺]
/// keeps the axis at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Fc⁺: Coulomb level while v > 0.
    pub fc_plus: f64,
    /// Fc⁻: Coulomb level while v < 0.
    pub fc_minus: f64,
    /// Fs⁺ ≥ Fc⁺: torque that must be exceeded to start in positive direction.
    pub fs_plus: f64,
    /// Fs⁻ ≥ Fc⁻: the same in negative direction.
    pub fs_minus: f64,
}

impl Friction {
    /// Friction whose static level is its Coulomb level.
    pub fn coulomb(fc_plus: f64, fc_minus: f64) -> Self {
        Self { fc_plus, fc_minus, fs_plus: fc_plus, fs_minus: fc_minus }
    }
}

/// A servo axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant {
    /// a, 1/s: the mechanics' pole is −a.
    pub viscous_rate_rad_s: f64,
    /// K, response units per input unit and second.
    pub constant: f64,
    /// A(s).
    pub actuator: Actuator,
    /// Dry friction.
    pub friction: Friction,
}

impl Plant {
    /// P(jω) = K/(jω + a).
    pub fn mechanics_response(&self, omega_rad_s: f64) -> Complex {
        self.constant / Complex::new(self.viscous_rate_rad_s, omega_rad_s)
    }
}
