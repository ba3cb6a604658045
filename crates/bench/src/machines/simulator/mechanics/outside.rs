//! Terms of the equations of motion that only outsiders have.

use super::super::parts::Parts;

/// What outsiders do behind the actuator.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct OutsideMechanics {
    cubic_drag: f64,
    weakening: f64,
    load_friction: f64,
    /// a·β/K, input units per response unit.
    kink: f64,
    knee: f64,
}

impl OutsideMechanics {
    /// `None` where nothing of it acts; `a_over_k` is a/K, input units per response unit.
    pub(super) fn of(parts: &Parts, a_over_k: f64) -> Option<Self> {
        let [beta, knee] = parts.viscous_kink;
        let outside = Self {
            cubic_drag: parts.cubic_drag,
            weakening: parts.field_weakening,
            load_friction: parts.load_friction,
            kink: a_over_k * beta,
            knee,
        };
        (outside != Self::default()).then_some(outside)
    }

    /// The torque that the motor gives at velocity v.
    pub(super) fn torque(&self, torque: f64, v: f64) -> f64 {
        torque / (1.0 + self.weakening * v * v)
    }

    /// Factor of all friction levels.
    pub(super) fn friction_factor(&self, torque: f64) -> f64 {
        1.0 + self.load_friction * torque.abs()
    }

    /// Torque against the motion, with the sign of v.
    pub(super) fn drag(&self, v: f64) -> f64 {
        let beyond = (v.abs() - self.knee).max(0.0).copysign(v);
        self.cubic_drag * v * v * v + self.kink * beyond
    }

    /// ∂(drag)/∂v at most, at speeds up to `speed`.
    pub(super) fn steepest(&self, speed: f64) -> f64 {
        3.0 * self.cubic_drag * speed * speed + self.kink
    }
}
