//! Outsiders: physics that no diagnosis has a name for, drawn in proportion to the machine that
//! they hide in.
//!
//! m is the lowest magnitude, F the mean Coulomb level and V = m·K/a.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use servoscope_core::effects::{Draws, MachineScales, Scaling, up_to};

use super::effect_draws::{Random, scales};
use crate::machines::draw::Draw;
use crate::machines::simulator::Effect;

/// How an outsider is drawn.
struct Outsider {
    id: &'static str,
    /// Parameters of a size that a lab would meet, by the sign of what may have either.
    draw: fn(&MachineScales, sign: f64, &mut dyn Draws) -> Vec<f64>,
    /// How much of it there is.
    scaled: Scaling,
}

const ALL: [Outsider; 8] = [
    // c·V³ = m × 0.01 … 0.2, at most 3 m.
    Outsider {
        id: "cubic_drag",
        draw: |scales, _, draws| {
            vec![scales.lowest / scales.velocity().powi(3) * draws.log_uniform(0.01, 0.2)]
        },
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 3.0 * scales.lowest / scales.velocity().powi(3))?])
        },
    },
    // κ·V² = 0.003 … 0.05, at most 0.25.
    Outsider {
        id: "field_weakening",
        draw: |scales, _, draws| vec![draws.log_uniform(0.003, 0.05) / scales.velocity().powi(2)],
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 0.25 / scales.velocity().powi(2))?])
        },
    },
    // μ·F = 0.03 … 0.3, at most 0.7.
    Outsider {
        id: "load_dependent_friction",
        draw: |scales, _, draws| vec![draws.log_uniform(0.03, 0.3) / scales.level()],
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 0.7 / scales.level())?])
        },
    },
    // β 0.1 … 1, at most 10; knee = V × 0.5 … 2.5.
    Outsider {
        id: "kinked_viscosity",
        draw: |scales, _, draws| {
            vec![draws.log_uniform(0.1, 1.0), scales.velocity() * draws.log_uniform(0.5, 2.5)]
        },
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 10.0)?, values[1]]),
    },
    // δ ± 0.02 … 0.2, at most 0.9.
    Outsider {
        id: "gain_drift",
        draw: |_, sign, draws| vec![sign * draws.log_uniform(0.02, 0.2)],
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 0.9)?]),
    },
    // δ ± 0.05 … 0.4, at most 0.9.
    Outsider {
        id: "viscous_drift",
        draw: |_, sign, draws| vec![sign * draws.log_uniform(0.05, 0.4)],
        scaled: |_, values, factor| Some(vec![up_to(values[0], factor, 0.9)?]),
    },
    // e·V = 0.03 … 0.3, at most 1.
    Outsider {
        id: "sensor_compression",
        draw: |scales, _, draws| vec![draws.log_uniform(0.03, 0.3) / scales.velocity()],
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 1.0 / scales.velocity())?])
        },
    },
    // step = m × 0.05 … 0.4, m at most and m/100 at least.
    Outsider {
        id: "input_quantisation",
        draw: |scales, _, draws| vec![scales.lowest * draws.log_uniform(0.05, 0.4)],
        scaled: |scales, values, factor| {
            let step = up_to(values[0], factor, scales.lowest)?;
            Some(vec![step.max(0.01 * scales.lowest)])
        },
    },
];

/// Ids of the outsiders.
pub fn ids() -> Vec<&'static str> {
    ALL.iter().map(|outsider| outsider.id).collect()
}

/// How an outsider is made larger; `None` where none has this id.
pub(super) fn scaling(id: &str) -> Option<Scaling> {
    ALL.iter().find(|outsider| outsider.id == id).map(|outsider| outsider.scaled)
}

/// Draws an outsider of a size that a lab would meet.
///
/// # Panics
/// If none has this id.
pub fn draw_outsider(id: &str, draw: &Draw, rng: &mut ChaCha8Rng) -> Effect {
    let outsider = ALL.iter().find(|outsider| outsider.id == id);
    let outsider = outsider.unwrap_or_else(|| panic!("no outsider is called `{id}`"));
    let sign = if rng.random() { 1.0 } else { -1.0 };
    Effect::of(id, &(outsider.draw)(&scales(draw), sign, &mut Random(rng)))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use servoscope_core::measurement::Complex;

    use super::super::sizing::Sizing;
    use super::*;
    use crate::machines::draw::draw;
    use crate::machines::simulator::{Effect, Machine, Settings, respond};

    /// Harmonics 0 to 7 at the highest magnitude of a machine of order 0, half way through
    /// the acquisition, and those of its base model.
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
        for (seed, id) in ids().into_iter().enumerate() {
            let machine = draw(0, seed as u64);
            let rng = &mut ChaCha8Rng::seed_from_u64(seed as u64);
            let effect = draw_outsider(id, &machine, rng);
            assert_eq!(effect.id(), id);
            effect.check().unwrap();
            let whole = departure(&both(&machine, effect));
            assert!(whole > 1e-4, "{id}: {whole:e}");
            let trace = Sizing::Amount.times(&scales(&machine), &effect, 1e-4).unwrap();
            let trace = departure(&both(&machine, trace));
            // In proportion to the size or faster; steps of a converter have a smallest one,
            // of m/100, whose harmonics above 7 carry most of its error.
            let most = if id == "input_quantisation" { 0.5 * whole } else { 2e-4 * whole + 1e-8 };
            assert!(trace < most, "{id}: {trace:e} of {whole:e}");
        }
    }

    #[test]
    fn without_friction_an_outsider_is_what_its_equation_says() {
        let mut machine = draw(0, 11);
        (machine.plant.friction.fc_plus, machine.plant.friction.fc_minus) = (0.0, 0.0);
        (machine.plant.friction.fs_plus, machine.plant.friction.fs_minus) = (0.0, 0.0);
        // Half way through a drift of 0.2 the gain, and with it the response, is 1.1.
        let [with, without] = both(&machine, Effect::of("gain_drift", &[0.2]));
        assert!((with[1] - 1.1 * without[1]).norm() < 1e-8 * without[1].norm());
        // (1 + s·v)^(-1/2) of a cosine of amplitude V: the third harmonic is -e²V³/8 to first
        // order in (eV)², here 1e-4.
        let amplitude = without[1].norm();
        let e = 0.01 / amplitude;
        let [with, without] = both(&machine, Effect::of("sensor_compression", &[e]));
        let third = -e * e * without[1] * without[1] * without[1] / 8.0;
        assert!((with[3] - third).norm() < 1e-3 * third.norm(), "{} {third}", with[3]);
    }
}
