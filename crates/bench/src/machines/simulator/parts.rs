//! What the effects of a machine make of it: the numbers that its equations read.

use super::effect::Effect;

/// Numbers of the equations of motion and of the chain ahead of them; by default they are those
/// of the base model. Torques are in input units, velocities in response units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Relative change of the command's gain over the acquisition.
    pub gain_drift: f64,
    /// Delay of the command, s.
    pub delay_s: f64,
    /// Half width of the dead zone of the command.
    pub dead_zone: f64,
    /// γ: the gain is 1 + γ for positive and 1 − γ for negative commands.
    pub gain_asymmetry: f64,
    /// Largest command.
    pub limit: f64,
    /// Whole steps that the command is rounded to, in place of dead zone, gain and limit.
    pub quantum: Option<f64>,
    /// Limit of the command's rate, per second.
    pub slew_rate: Option<f64>,
    /// Fs⁺ and Fs⁻ in place of the plant's.
    pub static_levels: Option<[f64; 2]>,
    /// r − 1 and vs of the Stribeck curve; breakaway at the larger of r·Fc and Fs.
    pub stribeck: Option<[f64; 2]>,
    /// σ of a bristle in place of set-valued friction.
    pub bristle_stiffness: Option<f64>,
    /// Relative change of all friction levels over the acquisition.
    pub friction_drift: f64,
    /// μ: all friction levels are × (1 + μ·|τ|).
    pub load_friction: f64,
    /// α: the viscous rate is a(1 + α) forwards and a(1 − α) backwards.
    pub viscous_asymmetry: f64,
    /// Relative change of a over the acquisition.
    pub viscous_drift: f64,
    /// c of a torque c·v·|v|.
    pub quadratic_drag: f64,
    /// c of a torque c·v³.
    pub cubic_drag: f64,
    /// β and knee: a becomes a(1 + β) for what |v| has beyond the knee.
    pub viscous_kink: [f64; 2],
    /// κ: the motor's torque falls to τ/(1 + κ·v²).
    pub field_weakening: f64,
    /// k and k₃ of a torque k·θ + k₃·θ³, θ = 0 at rest.
    pub spring: Option<[f64; 2]>,
    /// T, N and φ of a torque T·sin(N·θ + φ), together with the constant torque that makes the
    /// mean of v zero.
    pub cogging: Option<[f64; 3]>,
    /// ρ, k, c and the whole gap of a joint between motor and load.
    pub joint: Option<[f64; 4]>,
    /// T of a sensor T·y' + y = v, s.
    pub sensor_lag_s: Option<f64>,
    /// e of a sensor that reads v/√(1 + (e·v)²).
    pub compression: f64,
}

impl Default for Parts {
    fn default() -> Self {
        Self {
            gain_drift: 0.0,
            delay_s: 0.0,
            dead_zone: 0.0,
            gain_asymmetry: 0.0,
            limit: f64::INFINITY,
            quantum: None,
            slew_rate: None,
            static_levels: None,
            stribeck: None,
            bristle_stiffness: None,
            friction_drift: 0.0,
            load_friction: 0.0,
            viscous_asymmetry: 0.0,
            viscous_drift: 0.0,
            quadratic_drag: 0.0,
            cubic_drag: 0.0,
            viscous_kink: [0.0; 2],
            field_weakening: 0.0,
            spring: None,
            cogging: None,
            joint: None,
            sensor_lag_s: None,
            compression: 0.0,
        }
    }
}

impl Parts {
    /// What these effects make of a machine together.
    pub(super) fn of(effects: &[Effect]) -> Self {
        let mut parts = Self::default();
        effects.iter().for_each(|effect| effect.enter(&mut parts));
        parts
    }

    /// Adds a spring to the frame: stiffnesses of several add up.
    pub(super) fn add_spring(&mut self, stiffness: f64, cubic_stiffness: f64) {
        let [k, k3] = self.spring.unwrap_or_default();
        self.spring = Some([k + stiffness, k3 + cubic_stiffness]);
    }
}
