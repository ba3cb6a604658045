//! The place in the chain that an effect fills.

use super::effect::Effect;

/// A place in the chain of an axis (see [`super::axis::Axis`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// A dead zone of the input.
    DeadZone,
    /// A gain of the input that depends on its sign.
    Gain,
    /// A limit of the input.
    Saturation,
    /// A limit of the rate of the input.
    RateLimit,
    /// A delay of the input.
    Delay,
    /// Static friction levels.
    StaticLevel,
    /// Sliding friction as a function of velocity.
    FrictionCurve,
    /// A bristle in place of set-valued friction.
    Bristle,
    /// A factor on every friction level.
    FrictionScale,
    /// Viscous damping by direction.
    ViscousRate,
    /// A torque: any number of different ones add up.
    Torque,
    /// A load behind a joint.
    SecondMass,
    /// A lag of the sensor.
    SensorLag,
}

impl Slot {
    /// Whether different effects in this slot act together.
    fn is_shared(self) -> bool {
        self == Slot::Torque
    }
}

/// Two effects that cannot act together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{first}` and `{second}` cannot act together: both fill the same place in the chain ({slot:?})"
)]
pub struct SameSlot {
    /// Id of one.
    pub first: &'static str,
    /// Id of the other.
    pub second: &'static str,
    /// What both fill.
    pub slot: Slot,
}

/// Checks that effects can act together: none twice, and no two in a slot that one fills.
///
/// # Errors
/// The first two that cannot.
pub fn check_slots(effects: &[&dyn Effect]) -> Result<(), SameSlot> {
    for (i, first) in effects.iter().enumerate() {
        for second in &effects[i + 1..] {
            let same = first.id() == second.id();
            let slot = first.slot();
            if same || (slot == second.slot() && !slot.is_shared()) {
                return Err(SameSlot { first: first.id(), second: second.id(), slot });
            }
        }
    }
    Ok(())
}
