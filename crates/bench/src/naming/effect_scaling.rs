//! Scaling of an effect by the parameter that expresses its size.
//!
//! | effect | size | limit |
//! | --- | --- | --- |
//! | `static_friction` | Fs/Fc − 1, by the same factor in both directions | 2 |
//! | `stribeck` | r − 1 | 2 |
//! | `viscous_asymmetry` | α | ± 0.9 |
//! | `quadratic_drag` | c | c·V² = 3 m |
//! | `presliding` | 1/σ | σ = F/X; no stiffer than 10³ F/X |
//! | `friction_drift` | δ | ± 0.9 |
//! | `backlash`, `flexible_mode` | ρ, at the same resonance, damping ratio and gap | 0.85 |
//! | `spring` | k | K·k = a² |
//! | `hardening_spring` | k and k₃ together | K·k = a² |
//! | `cogging` | T | 2 F |
//! | `transport_delay`, `sensor_lag` | T | 1/a |
//! | `actuator_saturation` | depth: highest magnitude/limit − 1 | limit = m/2 |
//! | `actuator_dead_zone` | half width | 0.9 m |
//! | `gain_asymmetry` | γ | ± 0.8 |
//! | `slew_limit` | depth: highest m·ω/rate − 1 | rate = m·a/10 |
//! | `cubic_drag` | c | c·V³ = 3 m |
//! | `field_weakening` | κ | κ·V² = 0.25 |
//! | `load_dependent_friction` | μ | μ·F = 0.7 |
//! | `kinked_viscosity` | β | 10 |
//! | `gain_drift`, `viscous_drift` | δ | ± 0.9 |
//! | `sensor_compression` | e | e·V = 1 |
//! | `input_quantisation` | step | m; no finer than m/100 |
//!
//! Here m is the lowest magnitude, F the mean Coulomb level, V = m·K/a and X = V/a.

use crate::machines::draw::Draw;
use crate::machines::simulator::{Effect, Outsider};

/// Stiffest bristle, in units of F/X; the simulation time grows with the stiffness.
const STIFFEST_BRISTLE: f64 = 1e3;

/// Scales of a machine and its design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scales {
    /// a, 1/s.
    pub(super) a: f64,
    /// K, response units/(input unit·s).
    pub(super) constant: f64,
    /// F, input units.
    pub(super) level: f64,
    /// m, input units.
    pub(super) lowest: f64,
    /// Highest magnitude, input units.
    pub(super) highest: f64,
    /// Highest frequency, rad/s.
    pub(super) fastest_rad_s: f64,
    fc: [f64; 2],
}

impl Scales {
    pub(super) fn of(draw: &Draw) -> Self {
        let friction = draw.plant.friction;
        let magnitudes = || draw.design.iter().map(|(magnitude, _)| *magnitude);
        Self {
            a: draw.plant.viscous_rate_rad_s,
            constant: draw.plant.constant,
            level: 0.5 * (friction.fc_plus + friction.fc_minus),
            lowest: magnitudes().fold(f64::INFINITY, f64::min),
            highest: magnitudes().fold(0.0, f64::max),
            fastest_rad_s: draw.design.iter().map(|(_, omega)| *omega).fold(0.0, f64::max),
            fc: [friction.fc_plus, friction.fc_minus],
        }
    }

    /// V, response units.
    pub(super) fn velocity(&self) -> f64 {
        self.lowest * self.constant / self.a
    }

    /// X, response units·s.
    pub(super) fn travel(&self) -> f64 {
        self.velocity() / self.a
    }

    /// The effect, `factor` times as large; `None` if that exceeds the largest realistic value.
    pub(super) fn times(&self, effect: &Effect, factor: f64) -> Option<Effect> {
        let Self { a, constant, level, lowest, highest, .. } = *self;
        let (velocity, travel) = (self.velocity(), self.travel());
        let up_to = |value: f64, most: f64| {
            let scaled = factor * value;
            (scaled.abs() <= most).then_some(scaled)
        };
        // A spring of this stiffness has its resonance at a.
        let stiffest = a * a / constant;
        let joint = |fraction: f64, stiffness: f64, damping: f64| {
            let scaled = up_to(fraction, 0.85)?;
            let inertias = scaled * (1.0 - scaled) / (fraction * (1.0 - fraction));
            Some((scaled, inertias * stiffness, inertias * damping))
        };
        // A limit such that `reach`/limit − 1, the depth by which the input exceeds it, is scaled.
        let bound = |bound: f64, reach: f64, least: f64| {
            let lowered = reach / (1.0 + factor * (reach / bound - 1.0));
            (lowered >= least).then_some(lowered)
        };
        Some(match *effect {
            Effect::StaticFriction { fs_plus, fs_minus } => {
                let level = |fs: f64, fc: f64| Some(fc * (1.0 + up_to(fs / fc - 1.0, 2.0)?));
                Effect::StaticFriction {
                    fs_plus: level(fs_plus, self.fc[0])?,
                    fs_minus: level(fs_minus, self.fc[1])?,
                }
            }
            Effect::Stribeck { fs_over_fc, stribeck_velocity } => {
                let fs_over_fc = 1.0 + up_to(fs_over_fc - 1.0, 2.0)?;
                Effect::Stribeck { fs_over_fc, stribeck_velocity }
            }
            Effect::ViscousAsymmetry { alpha } => {
                Effect::ViscousAsymmetry { alpha: up_to(alpha, 0.9)? }
            }
            Effect::QuadraticDrag { c } => {
                Effect::QuadraticDrag { c: up_to(c, 3.0 * lowest / velocity.powi(2))? }
            }
            Effect::Presliding { sigma } => {
                let softest = level / travel;
                let sigma = (sigma / factor).min(STIFFEST_BRISTLE * softest);
                (sigma >= softest).then_some(Effect::Presliding { sigma })?
            }
            Effect::FrictionDrift { delta } => Effect::FrictionDrift { delta: up_to(delta, 0.9)? },
            Effect::Backlash { load_inertia_fraction, stiffness, damping, gap } => {
                let (load_inertia_fraction, stiffness, damping) =
                    joint(load_inertia_fraction, stiffness, damping)?;
                Effect::Backlash { load_inertia_fraction, stiffness, damping, gap }
            }
            Effect::FlexibleMode { load_inertia_fraction, stiffness, damping } => {
                let (load_inertia_fraction, stiffness, damping) =
                    joint(load_inertia_fraction, stiffness, damping)?;
                Effect::FlexibleMode { load_inertia_fraction, stiffness, damping }
            }
            Effect::Spring { stiffness } => {
                Effect::Spring { stiffness: up_to(stiffness, stiffest)? }
            }
            Effect::HardeningSpring { stiffness, cubic_stiffness } => Effect::HardeningSpring {
                stiffness: up_to(stiffness, stiffest)?,
                cubic_stiffness: factor * cubic_stiffness,
            },
            Effect::Cogging { amplitude, cycles_per_unit, phase } => {
                let amplitude = up_to(amplitude, 2.0 * level)?;
                Effect::Cogging { amplitude, cycles_per_unit, phase }
            }
            Effect::TransportDelay { delay } => {
                Effect::TransportDelay { delay: up_to(delay, 1.0 / a)? }
            }
            Effect::SensorLag { time_constant } => {
                Effect::SensorLag { time_constant: up_to(time_constant, 1.0 / a)? }
            }
            Effect::ActuatorSaturation { limit } => {
                Effect::ActuatorSaturation { limit: bound(limit, highest, 0.5 * lowest)? }
            }
            Effect::ActuatorDeadZone { half_width } => {
                Effect::ActuatorDeadZone { half_width: up_to(half_width, 0.9 * lowest)? }
            }
            Effect::GainAsymmetry { gamma } => Effect::GainAsymmetry { gamma: up_to(gamma, 0.8)? },
            Effect::SlewLimit { rate } => {
                let steepest = highest * self.fastest_rad_s;
                Effect::SlewLimit { rate: bound(rate, steepest, 0.1 * lowest * a)? }
            }
            Effect::Outside(outsider) => Effect::Outside(self.outsider_times(outsider, factor)?),
        })
    }

    fn outsider_times(&self, outsider: Outsider, factor: f64) -> Option<Outsider> {
        let velocity = self.velocity();
        let up_to = |value: f64, most: f64| {
            let scaled = factor * value;
            (scaled.abs() <= most).then_some(scaled)
        };
        Some(match outsider {
            Outsider::CubicDrag { c } => {
                Outsider::CubicDrag { c: up_to(c, 3.0 * self.lowest / velocity.powi(3))? }
            }
            Outsider::FieldWeakening { kappa } => {
                Outsider::FieldWeakening { kappa: up_to(kappa, 0.25 / velocity.powi(2))? }
            }
            Outsider::LoadDependentFriction { mu } => {
                Outsider::LoadDependentFriction { mu: up_to(mu, 0.7 / self.level)? }
            }
            Outsider::KinkedViscosity { beta, knee } => {
                Outsider::KinkedViscosity { beta: up_to(beta, 10.0)?, knee }
            }
            Outsider::GainDrift { delta } => Outsider::GainDrift { delta: up_to(delta, 0.9)? },
            Outsider::ViscousDrift { delta } => {
                Outsider::ViscousDrift { delta: up_to(delta, 0.9)? }
            }
            Outsider::SensorCompression { e } => {
                Outsider::SensorCompression { e: up_to(e, 1.0 / velocity)? }
            }
            Outsider::InputQuantisation { step } => {
                let step = up_to(step, self.lowest)?.max(0.01 * self.lowest);
                Outsider::InputQuantisation { step }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::super::outsiders::{OUTSIDERS, draw_outsider};
    use super::*;
    use crate::machines::draw::draw;
    use crate::machines::effect_draws::{IDS, draw_effect};

    fn everything(machine: &Draw, seed: u64) -> Vec<Effect> {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut effects: Vec<Effect> = IDS.map(|id| draw_effect(id, machine, rng)).into();
        effects.extend(OUTSIDERS.map(|id| Effect::Outside(draw_outsider(id, machine, rng))));
        effects
    }

    #[test]
    fn a_factor_of_one_changes_nothing_and_no_machine_has_ten_thousand_times_as_much() {
        for seed in 0..20 {
            let machine = draw((seed % 3) as u8, seed);
            let scales = Scales::of(&machine);
            for effect in everything(&machine, seed) {
                let same = scales.times(&effect, 1.0).unwrap();
                for (found, expected) in same.parameters().iter().zip(effect.parameters()) {
                    // Rounding of a few operations.
                    assert!((found.1 - expected.1).abs() <= 1e-12 * expected.1.abs(), "{effect:?}");
                }
                let smaller = scales.times(&effect, 0.1).unwrap();
                smaller.check().unwrap();
                assert_eq!(scales.times(&effect, 1e4), None, "{effect:?}");
            }
        }
    }

    #[test]
    fn a_joint_with_less_load_keeps_its_resonance_and_damping_ratio() {
        let machine = draw(0, 3);
        let rng = &mut ChaCha8Rng::seed_from_u64(3);
        let effect = draw_effect("flexible_mode", &machine, rng);
        let modal = |effect: &Effect| match *effect {
            Effect::FlexibleMode { load_inertia_fraction: rho, stiffness, damping } => {
                let inertia = rho * (1.0 - rho) / machine.plant.constant;
                [stiffness / inertia, damping / inertia]
            }
            _ => panic!("another effect"),
        };
        let smaller = Scales::of(&machine).times(&effect, 0.2).unwrap();
        for (found, expected) in modal(&smaller).into_iter().zip(modal(&effect)) {
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
    }
}
