//! How a benchmark draws an effect, in proportion to the machine that it is hidden in.

use std::fmt::Debug;

/// Scales of a drawn machine and of the experiments on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachineScales {
    /// a, 1/s.
    pub viscous_rate: f64,
    /// K, velocity units per input unit and second.
    pub constant: f64,
    /// Fc⁺ and Fc⁻, input units.
    pub coulomb: [f64; 2],
    /// Lowest magnitude m, input units.
    pub lowest: f64,
    /// Highest magnitude, input units.
    pub highest: f64,
    /// Highest frequency, rad/s.
    pub fastest_rad_s: f64,
}

impl MachineScales {
    /// F: mean Coulomb level, input units.
    pub fn level(&self) -> f64 {
        0.5 * (self.coulomb[0] + self.coulomb[1])
    }

    /// V = m·K/a: velocity at the lowest magnitude without friction, velocity units.
    pub fn velocity(&self) -> f64 {
        self.lowest * self.constant / self.viscous_rate
    }

    /// X = V/a: travel at the lowest magnitude, velocity units times second.
    pub fn travel(&self) -> f64 {
        self.velocity() / self.viscous_rate
    }

    /// k of a spring with which K resonates at a: K·k = a².
    pub fn stiffness(&self) -> f64 {
        self.viscous_rate * self.viscous_rate / self.constant
    }
}

/// Random numbers for a draw.
pub trait Draws {
    /// Log-uniform between two positive ends.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64;

    /// Uniform in size between two positive ends, of either sign.
    fn signed(&mut self, low: f64, high: f64) -> f64;
}

/// Parameters of the effect `factor` times as large; `None` where no machine would have that.
pub type Scaling = fn(&MachineScales, values: &[f64], factor: f64) -> Option<Vec<f64>>;

/// How a benchmark draws an effect.
#[derive(Debug, Clone, Copy)]
pub struct DrawPlan {
    /// Parameters of a size that a lab would meet.
    pub draw: fn(&MachineScales, &mut dyn Draws) -> Vec<f64>,
    /// Changes how much there is of the effect.
    pub scaled: Scaling,
    /// Changes its character instead, as the resonance of a joint, where it has one.
    pub by_character: Option<Scaling>,
}

/// `factor` times a value, unless that exceeds `most` in size.
pub fn up_to(value: f64, factor: f64, most: f64) -> Option<f64> {
    let scaled = factor * value;
    (scaled.abs() <= most).then_some(scaled)
}

/// A limit that the largest command exceeds `factor` times as far: of command/limit − 1. `None`
/// where the limit would be below `least`.
pub fn lowered(limit: f64, factor: f64, command: f64, least: f64) -> Option<f64> {
    let lowered = command / (1.0 + factor * (command / limit - 1.0));
    (lowered >= least).then_some(lowered)
}
