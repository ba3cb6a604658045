//! How the benchmark draws an effect at random, scaled to the machine in which it is hidden.

use std::fmt::Debug;

/// Scales of a randomly drawn machine and of the experiments on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachineScales {
    /// Viscous rate a, 1/s.
    pub viscous_rate: f64,
    /// Constant K, velocity units per input unit and second.
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
    /// F: mean of Fc⁺ and Fc⁻, input units.
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

    /// Stiffness k of a spring whose resonance √(K·k) equals a.
    pub fn stiffness(&self) -> f64 {
        self.viscous_rate * self.viscous_rate / self.constant
    }
}

/// A source of random numbers for a draw.
pub trait Draws {
    /// Log-uniform between `low` and `high`, both positive.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64;

    /// Uniform in size between `low` and `high`, both positive, with a random sign.
    fn signed(&mut self, low: f64, high: f64) -> f64;
}

/// Draws that give the middle of every range: an effect of typical size.
#[derive(Debug, Clone, Copy)]
pub struct Middle;

impl Draws for Middle {
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        (low * high).sqrt()
    }

    fn signed(&mut self, low: f64, high: f64) -> f64 {
        (low * high).sqrt()
    }
}

/// Parameters of the effect `factor` times as large; `None` if no machine would have that.
pub type Scaling = fn(&MachineScales, values: &[f64], factor: f64) -> Option<Vec<f64>>;

/// How the benchmark draws an effect and varies its size.
#[derive(Debug, Clone, Copy)]
pub struct DrawPlan {
    /// Draws parameters of a size that a laboratory would meet.
    pub draw: fn(&MachineScales, &mut dyn Draws) -> Vec<f64>,
    /// Scales the amount of the effect.
    pub scaled: Scaling,
    /// Scales another property instead, such as the resonance of a joint, if it has one.
    pub by_character: Option<Scaling>,
}

/// `factor`·`value`; `None` if its size exceeds `most`.
pub fn up_to(value: f64, factor: f64, most: f64) -> Option<f64> {
    let scaled = factor * value;
    (scaled.abs() <= most).then_some(scaled)
}

/// The limit for which the largest command's relative excess, command/limit − 1, is `factor` times
/// as large; `None` if that is below `least`.
pub fn lowered(limit: f64, factor: f64, command: f64, least: f64) -> Option<f64> {
    let lowered = command / (1.0 + factor * (command / limit - 1.0));
    (lowered >= least).then_some(lowered)
}
