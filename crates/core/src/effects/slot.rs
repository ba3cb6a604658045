//! Slots: the parts of an axis that effects take, and which effects can act together.

use super::effect::Effect;

/// The part of an [`Axis`](super::axis::Axis) that an effect takes.
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
    /// The static friction levels.
    StaticLevel,
    /// The dependence of sliding friction on velocity.
    FrictionCurve,
    /// A Dahl bristle in place of set-valued friction.
    Bristle,
    /// A factor on all friction levels.
    FrictionScale,
    /// Viscous damping that depends on the direction of motion.
    ViscousRate,
    /// A torque on the mechanics. Any number of different torques add up.
    Torque,
    /// A load behind a joint.
    SecondMass,
    /// A lag of the sensor.
    SensorLag,
}

impl Slot {
    /// Whether different effects in this slot can act together.
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
    /// Id of the first.
    pub first: &'static str,
    /// Id of the second.
    pub second: &'static str,
    /// The slot of the first.
    pub slot: Slot,
}

/// Checks that effects can act together: none occurs twice, no two share a slot but
/// [`Slot::Torque`].
///
/// # Errors
/// [`SameSlot`] with the first two that cannot.
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
