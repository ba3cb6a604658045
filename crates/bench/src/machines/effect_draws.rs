//! Draws random effects whose size is realistic for a given machine.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{Draw, log_uniform};
use super::simulator::Effect;

/// Every effect id that [`draw_effect`] accepts.
pub const IDS: [&str; 17] = [
    "static_friction",
    "stribeck",
    "viscous_asymmetry",
    "quadratic_drag",
    "presliding",
    "friction_drift",
    "backlash",
    "flexible_mode",
    "spring",
    "hardening_spring",
    "cogging",
    "transport_delay",
    "sensor_lag",
    "actuator_saturation",
    "actuator_dead_zone",
    "gain_asymmetry",
    "slew_limit",
];

/// Draws an effect of a size that is realistic for the machine and design of `draw`. With m the
/// lowest magnitude, F the mean Coulomb level, V = m·K/a and X = V/a. Ranges are log-uniform,
/// except that those after ± are uniform with a random sign.
///
/// | effect | ranges |
/// | --- | --- |
/// | `static_friction` | Fs = Fc × 1.1 … 1.9 each |
/// | `stribeck` | r 1.1 … 1.8, vs = V × 0.03 … 0.5 |
/// | `viscous_asymmetry` | α ± 0.05 … 0.3 |
/// | `quadratic_drag` | c·V² = m × 0.02 … 0.3 |
/// | `presliding` | σ = F/X × 3 … 60 |
/// | `friction_drift` | δ ± 0.1 … 0.4 |
/// | `flexible_mode` | ρ 0.2 … 0.6, resonance a × 2 … 10, its damping ratio 0.01 … 0.3 |
/// | `backlash` | the same, damping ratio 0.05 … 0.5, gap = X × 0.001 … 0.3 |
/// | `spring`, `hardening_spring` | K·k = a² × 0.02 … 0.3 (half of it), k₃·X³ = m × 0.0001 … 0.3 |
/// | `cogging` | T = F × 0.1 … 0.6, N = 1/X × 1 … 10, φ any |
/// | `transport_delay`, `sensor_lag` | T = 1/a × 0.005 … 0.05 |
/// | `actuator_saturation` | limit = m × 1.3 … 3.6 |
/// | `actuator_dead_zone` | half width = F × 0.1 … 0.5 |
/// | `gain_asymmetry` | γ ± 0.03 … 0.2 |
/// | `slew_limit` | rate = m·a × 1 … 10 |
///
/// # Panics
/// If no effect has this id, or the design is empty.
pub fn draw_effect(id: &str, draw: &Draw, rng: &mut ChaCha8Rng) -> Effect {
    let (a, k) = (draw.plant.viscous_rate_rad_s, draw.plant.constant);
    let friction = draw.plant.friction;
    let level = 0.5 * (friction.fc_plus + friction.fc_minus);
    let lowest = draw.design.iter().map(|(m, _)| *m).fold(f64::INFINITY, f64::min);
    assert!(lowest.is_finite(), "an empty design");
    let velocity = lowest * k / a;
    let travel = velocity / a;
    let mut signed = |low: f64, high: f64| {
        let size = rng.random_range(low..=high);
        if rng.random() { size } else { -size }
    };
    match id {
        "viscous_asymmetry" => return Effect::ViscousAsymmetry { alpha: signed(0.05, 0.3) },
        "friction_drift" => return Effect::FrictionDrift { delta: signed(0.1, 0.4) },
        "gain_asymmetry" => return Effect::GainAsymmetry { gamma: signed(0.03, 0.2) },
        _ => {}
    }
    let mut times = |low: f64, high: f64| log_uniform(low, high, rng);
    match id {
        "static_friction" => Effect::StaticFriction {
            fs_plus: friction.fc_plus * times(1.1, 1.9),
            fs_minus: friction.fc_minus * times(1.1, 1.9),
        },
        "stribeck" => Effect::Stribeck {
            fs_over_fc: times(1.1, 1.8),
            stribeck_velocity: velocity * times(0.03, 0.5),
        },
        "quadratic_drag" => {
            Effect::QuadraticDrag { c: lowest / (velocity * velocity) * times(0.02, 0.3) }
        }
        "presliding" => Effect::Presliding { sigma: level / travel * times(3.0, 60.0) },
        "backlash" | "flexible_mode" => {
            let load_inertia_fraction = times(0.2, 0.6);
            let resonance = a * times(2.0, 10.0);
            let inertia = load_inertia_fraction * (1.0 - load_inertia_fraction) / k;
            let stiffness = resonance * resonance * inertia;
            let per_ratio = 2.0 * resonance * inertia;
            if id == "flexible_mode" {
                let damping = per_ratio * times(0.01, 0.3);
                Effect::FlexibleMode { load_inertia_fraction, stiffness, damping }
            } else {
                let damping = per_ratio * times(0.05, 0.5);
                let gap = travel * times(0.001, 0.3);
                Effect::Backlash { load_inertia_fraction, stiffness, damping, gap }
            }
        }
        "spring" => Effect::Spring { stiffness: a * a / k * times(0.02, 0.3) },
        "hardening_spring" => Effect::HardeningSpring {
            stiffness: 0.5 * a * a / k * times(0.02, 0.3),
            cubic_stiffness: lowest / travel.powi(3) * times(0.0001, 0.3),
        },
        "cogging" => Effect::Cogging {
            amplitude: level * times(0.1, 0.6),
            cycles_per_unit: times(1.0, 10.0) / travel,
            phase: TAU * times(0.01, 1.0),
        },
        "transport_delay" => Effect::TransportDelay { delay: times(0.005, 0.05) / a },
        "sensor_lag" => Effect::SensorLag { time_constant: times(0.005, 0.05) / a },
        "actuator_saturation" => Effect::ActuatorSaturation { limit: lowest * times(1.3, 3.6) },
        "actuator_dead_zone" => Effect::ActuatorDeadZone { half_width: level * times(0.1, 0.5) },
        "slew_limit" => Effect::SlewLimit { rate: lowest * a * times(1.0, 10.0) },
        _ => panic!("no effect is called `{id}`"),
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::super::draw::draw;
    use super::*;

    #[test]
    fn every_effect_is_drawn_with_parameters_it_can_have() {
        for id in IDS {
            for seed in 0..50 {
                let rng = &mut ChaCha8Rng::seed_from_u64(seed);
                let effect = draw_effect(id, &draw(0, seed), rng);
                assert_eq!(effect.id(), id);
                effect.check().unwrap();
                let again = &mut ChaCha8Rng::seed_from_u64(seed);
                assert_eq!(draw_effect(id, &draw(0, seed), again), effect);
            }
        }
    }
}
