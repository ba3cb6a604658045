//! Dry friction: its levels, the Stribeck curve, and the bristle that replaces it in presliding.

use super::effect::Effect;
use crate::plant::Friction;

/// Dry friction of a machine at one position in the order of acquisition.
#[derive(Debug, Clone, Copy)]
pub(super) struct DryFriction {
    /// Coulomb levels, and static levels at which the axis breaks away, input units.
    pub(super) levels: Friction,
    /// r − 1 and vs of the Stribeck curve.
    pub(super) stribeck: Option<(f64, f64)>,
    /// σ of the bristle that replaces set-valued friction.
    pub(super) bristle_stiffness: Option<f64>,
}

impl DryFriction {
    pub(super) fn of(friction: &Friction, effects: &[Effect], run_share: f64) -> Self {
        let mut levels = *friction;
        let (mut stribeck, mut bristle_stiffness, mut factor) = (None, None, 1.0);
        for effect in effects {
            match *effect {
                Effect::StaticFriction { fs_plus, fs_minus } => {
                    levels = Friction { fs_plus, fs_minus, ..levels };
                }
                Effect::Stribeck { fs_over_fc, stribeck_velocity } => {
                    stribeck = Some((fs_over_fc - 1.0, stribeck_velocity));
                }
                Effect::Presliding { sigma } => bristle_stiffness = Some(sigma),
                Effect::FrictionDrift { delta } => factor = 1.0 + delta * run_share,
                _ => {}
            }
        }
        let peak = 1.0 + stribeck.map_or(0.0, |(excess, _)| excess);
        let levels = Friction {
            fc_plus: factor * levels.fc_plus,
            fc_minus: factor * levels.fc_minus,
            fs_plus: factor * levels.fs_plus.max(peak * levels.fc_plus),
            fs_minus: factor * levels.fs_minus.max(peak * levels.fc_minus),
        };
        Self { levels, stribeck, bristle_stiffness }
    }

    /// Absolute value of the friction in a direction (+1 or −1) at velocity v, input units.
    #[inline]
    pub(super) fn kinetic(&self, direction: f64, velocity: f64) -> f64 {
        let level = if direction > 0.0 { self.levels.fc_plus } else { self.levels.fc_minus };
        match self.stribeck {
            Some((excess, vs)) => level * (1.0 + excess * (-(velocity / vs).powi(2)).exp()),
            None => level,
        }
    }

    /// z' of the bristle: v − |v|·σ·z/Fc.
    pub(super) fn bristle_slope(&self, sigma: f64, direction: f64, velocity: f64, z: f64) -> f64 {
        velocity - direction * velocity * sigma * z / self.kinetic(direction, velocity)
    }
}
