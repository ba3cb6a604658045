//! Whether a machine and its input can be simulated, and why not.

use super::parts::Parts;
use super::{MOST_STEPS, Machine, Unusable};
use crate::measurement::Complex;
use crate::plant::Actuator;

/// Why a machine has no periodic response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulatorError {
    /// A parameter has an invalid value.
    #[error("{quantity} is {value}: it must be finite and {requirement}")]
    Unusable {
        /// Which parameter.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// An effect is invalid.
    #[error(transparent)]
    Effect(#[from] Unusable),
    /// An effect is given more than once.
    #[error("`{id}` is given more than once")]
    Repeated {
        /// Which effect.
        id: &'static str,
    },
    /// A joint is given both with and without a gap.
    #[error("`backlash` and `flexible_mode` describe the same joint: give one of them")]
    TwoJoints,
    /// The period is too long for the plant's fastest time constant.
    #[error("a period would take {steps} steps, more than {MOST_STEPS}")]
    TooManySteps {
        /// Steps per period that the settings demand.
        steps: f64,
    },
    /// No response of the input's period is reached from rest.
    #[error("after {periods} periods the state still changes by {change:e} of its range a period")]
    NotPeriodic {
        /// Periods simulated.
        periods: usize,
        /// Change of the state over the last period, as a share of its largest value.
        change: f64,
    },
}

/// Checks the parameters of a machine, its effects and its input.
pub(super) fn check(
    machine: &Machine,
    run_share: f64,
    omega_rad_s: f64,
    input: &[Complex],
) -> Result<(), SimulatorError> {
    let plant = &machine.plant;
    let positive = |quantity, value: f64| {
        let requirement = "positive";
        let usable = value.is_finite() && value > 0.0;
        usable.then_some(()).ok_or(SimulatorError::Unusable { quantity, value, requirement })
    };
    let level = |quantity, value: f64, least: f64, requirement| {
        let usable = value.is_finite() && value >= least;
        usable.then_some(()).ok_or(SimulatorError::Unusable { quantity, value, requirement })
    };
    positive("the fundamental frequency", omega_rad_s)?;
    positive("a", plant.viscous_rate_rad_s)?;
    positive("K", plant.constant)?;
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => positive("the actuator's corner", corner_rad_s)?,
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            positive("the actuator's natural frequency", natural_frequency_rad_s)?;
            positive("the actuator's damping ratio", damping_ratio)?;
        }
    }
    for (place, effect) in machine.effects.iter().enumerate() {
        effect.check()?;
        if machine.effects[..place].iter().any(|earlier| earlier.id() == effect.id()) {
            return Err(SimulatorError::Repeated { id: effect.id() });
        }
    }
    let has = |id: &str| machine.effects.iter().any(|effect| effect.id() == id);
    if has("backlash") && has("flexible_mode") {
        return Err(SimulatorError::TwoJoints);
    }
    let friction = &plant.friction;
    level("Fc+", friction.fc_plus, 0.0, "at least 0")?;
    level("Fc-", friction.fc_minus, 0.0, "at least 0")?;
    level("Fs+", friction.fs_plus, friction.fc_plus, "at least Fc+")?;
    level("Fs-", friction.fs_minus, friction.fc_minus, "at least Fc-")?;
    let parts = Parts::of(machine.effects);
    if let Some([fs_plus, fs_minus]) = parts.static_levels {
        level("Fs+", fs_plus, friction.fc_plus, "at least Fc+")?;
        level("Fs-", fs_minus, friction.fc_minus, "at least Fc-")?;
    }
    if parts.bristle_stiffness.is_some() {
        positive("Fc+ of a bristle", friction.fc_plus)?;
        positive("Fc- of a bristle", friction.fc_minus)?;
    }
    if !(0.0..=1.0).contains(&run_share) {
        let (quantity, requirement) = ("the share of the run", "from 0 to 1");
        return Err(SimulatorError::Unusable { quantity, value: run_share, requirement });
    }
    for value in input.iter().flat_map(|line| [line.re, line.im]) {
        level("a line of the input", value, f64::NEG_INFINITY, "a number")?;
    }
    Ok(())
}
