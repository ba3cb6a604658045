//! Draws random outsiders whose size is realistic for a given machine.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::effect_scaling::Scales;
use crate::machines::draw::{Draw, log_uniform};
use crate::machines::simulator::Outsider;

/// Every outsider id that [`draw_outsider`] accepts.
pub const OUTSIDERS: [&str; 8] = [
    "cubic_drag",
    "field_weakening",
    "load_dependent_friction",
    "kinked_viscosity",
    "gain_drift",
    "viscous_drift",
    "sensor_compression",
    "input_quantisation",
];

/// Draws an outsider of a size that is realistic for the machine and design of `draw`. With m the
/// lowest magnitude, F the mean Coulomb level and V = m·K/a (all ranges are log-uniform; ± stands
/// for a random sign):
///
/// | outsider | ranges |
/// | --- | --- |
/// | `cubic_drag` | c·V³ = m × 0.01 … 0.2 |
/// | `field_weakening` | κ·V² = 0.003 … 0.05 |
/// | `load_dependent_friction` | μ·F = 0.03 … 0.3 |
/// | `kinked_viscosity` | β 0.1 … 1, knee = V × 0.5 … 2.5 |
/// | `gain_drift` | δ ± 0.02 … 0.2 |
/// | `viscous_drift` | δ ± 0.05 … 0.4 |
/// | `sensor_compression` | e·V = 0.03 … 0.3 |
/// | `input_quantisation` | step = m × 0.05 … 0.4 |
///
/// # Panics
/// If no outsider has this id.
pub fn draw_outsider(id: &str, draw: &Draw, rng: &mut ChaCha8Rng) -> Outsider {
    let scales = Scales::of(draw);
    let (lowest, velocity) = (scales.lowest, scales.velocity());
    let sign = if rng.random() { 1.0 } else { -1.0 };
    let mut times = |low: f64, high: f64| log_uniform(low, high, rng);
    match id {
        "cubic_drag" => Outsider::CubicDrag { c: lowest / velocity.powi(3) * times(0.01, 0.2) },
        "field_weakening" => {
            Outsider::FieldWeakening { kappa: times(0.003, 0.05) / velocity.powi(2) }
        }
        "load_dependent_friction" => {
            Outsider::LoadDependentFriction { mu: times(0.03, 0.3) / scales.level }
        }
        "kinked_viscosity" => {
            Outsider::KinkedViscosity { beta: times(0.1, 1.0), knee: velocity * times(0.5, 2.5) }
        }
        "gain_drift" => Outsider::GainDrift { delta: sign * times(0.02, 0.2) },
        "viscous_drift" => Outsider::ViscousDrift { delta: sign * times(0.05, 0.4) },
        "sensor_compression" => Outsider::SensorCompression { e: times(0.03, 0.3) / velocity },
        "input_quantisation" => Outsider::InputQuantisation { step: lowest * times(0.05, 0.4) },
        _ => panic!("no outsider is called `{id}`"),
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use servoscope_core::measurement::Complex;

    use super::*;
    use crate::machines::draw::draw;
    use crate::machines::simulator::{Effect, Machine, Settings, respond};

    /// Harmonics 0 to 7 of a machine with the effect and of its base model, at the highest
    /// magnitude and half-way through the acquisition.
    fn both(machine: &Draw, effect: Effect) -> [Vec<Complex>; 2] {
        let (magnitude, _) = machine.design[47];
        let omega_rad_s = machine.plant.viscous_rate_rad_s;
        let input = [Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
        [vec![effect], vec![]].map(|effects: Vec<Effect>| {
            let machine = Machine { plant: machine.plant, effects: &effects };
            respond(&machine, 0.5, omega_rad_s, &input, 7, &Settings::default()).unwrap()
        })
    }

    fn departure([with, without]: &[Vec<Complex>; 2]) -> f64 {
        let difference = with.iter().zip(without).map(|(w, b)| (w - b).norm());
        difference.fold(0.0, f64::max) / without[1].norm()
    }

    #[test]
    fn every_outsider_departs_from_the_base_model_and_vanishes_with_its_size() {
        for (seed, id) in OUTSIDERS.into_iter().enumerate() {
            let machine = draw(0, seed as u64);
            let rng = &mut ChaCha8Rng::seed_from_u64(seed as u64);
            let outsider = draw_outsider(id, &machine, rng);
            assert_eq!(outsider.id(), id);
            let effect = Effect::Outside(outsider);
            effect.check().unwrap();
            let whole = departure(&both(&machine, effect));
            assert!(whole > 1e-4, "{id}: {whole:e}");
            let trace = Scales::of(&machine).times(&effect, 1e-4).unwrap();
            let trace = departure(&both(&machine, trace));
            // The deviation shrinks at least in proportion to the size. Only quantisation has a
            // smallest step, m/100, and most of its error is in harmonics above 7.
            let most = if id == "input_quantisation" { 0.5 * whole } else { 2e-4 * whole + 1e-8 };
            assert!(trace < most, "{id}: {trace:e} of {whole:e}");
        }
    }

    #[test]
    fn without_friction_an_outsider_is_what_its_equation_says() {
        let mut machine = draw(0, 11);
        (machine.plant.friction.fc_plus, machine.plant.friction.fc_minus) = (0.0, 0.0);
        (machine.plant.friction.fs_plus, machine.plant.friction.fs_minus) = (0.0, 0.0);
        // Half-way through a drift of 0.2 the gain is 1.1, and so is the response ratio.
        let [with, without] = both(&machine, Effect::Outside(Outsider::GainDrift { delta: 0.2 }));
        assert!((with[1] - 1.1 * without[1]).norm() < 1e-8 * without[1].norm());
        // For a cosine of amplitude V, v/√(1 + (e·v)²) has the third harmonic −e²V³/8 to first
        // order in (eV)², which is 1e-4 here.
        let amplitude = without[1].norm();
        let e = 0.01 / amplitude;
        let [with, without] = both(&machine, Effect::Outside(Outsider::SensorCompression { e }));
        let third = -e * e * without[1] * without[1] * without[1] / 8.0;
        assert!((with[3] - third).norm() < 1e-3 * third.norm(), "{} {third}", with[3]);
    }
}
