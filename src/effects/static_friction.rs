//! Static friction above the Coulomb level, at v = 0 only.

use crate::plant::{Friction, Plant};

use super::Effect;

/// Fs > Fc at v = 0 only: the axis rests longer at every reversal and starts
/// with a jump of acceleration. Imitated by `stribeck`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticFriction {
    /// Fs⁺, input units; below Fc⁺ it is Fc⁺.
    pub fs_plus: f64,
    /// Fs⁻, input units; below Fc⁻ it is Fc⁻.
    pub fs_minus: f64,
}

impl Effect for StaticFriction {
    fn id(&self) -> &'static str {
        "static_friction"
    }

    fn enter(&self, plant: Plant) -> Plant {
        let friction = plant.friction;
        let friction = Friction {
            fs_plus: self.fs_plus.max(friction.fc_plus),
            fs_minus: self.fs_minus.max(friction.fc_minus),
            ..friction
        };
        Plant { friction, ..plant }
    }
}
