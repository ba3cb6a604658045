//! Tables to identify and to diagnose, from the independent simulator.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoscope_core::answers::PlantRequest;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::plant::{Actuator, Friction, Plant};

use crate::machines::draw::{Draw, NoiseStatement, draw, measure};
use crate::machines::simulator::Effect;
use crate::naming::effect_draws::draw_effect;
use crate::naming::outsiders::draw_outsider;

/// Seed of the machine, of what is hidden in it and of the noise.
const SEED: u64 = 1;

/// G1 as its reference file measures it: 39 points, harmonics 0 to 9, no noise.
pub fn g1() -> Draw {
    reference(Actuator::Direct, 100.0)
}

/// G2, likewise: G1 behind a resonance.
pub fn g2() -> Draw {
    let natural_frequency_rad_s = 1000.0_f64.sqrt();
    let damping_ratio = 2.5 / natural_frequency_rad_s;
    reference(Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio }, 80.0)
}

fn reference(actuator: Actuator, highest_rad_s: f64) -> Draw {
    let plant = Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let design = [1.0, 2.0, 4.0]
        .into_iter()
        .flat_map(|m| (0..13).map(move |i| (m, highest_rad_s.powf(f64::from(i) / 12.0))))
        .collect();
    Draw {
        plant,
        effects: Vec::new(),
        design,
        harmonics: 9,
        noise_db: None,
        noise_statement: NoiseStatement::Silent,
    }
}

/// What a machine hides from the base model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    /// Nothing.
    Nothing,
    /// Static friction.
    One,
    /// Static friction and a spring.
    Two,
    /// Cubic drag, which the library lacks.
    Outsider,
}

impl Hidden {
    /// Every one, with its name.
    pub const ALL: [(&'static str, Self); 4] = [
        ("clean", Self::Nothing),
        ("one_hidden", Self::One),
        ("two_hidden", Self::Two),
        ("outsider", Self::Outsider),
    ];

    /// A machine of order 0 that hides it, measured at 48 points with 8 harmonics each and noise
    /// of 60 dB.
    pub fn machine(self) -> Draw {
        let machine = draw(0, SEED);
        let rng = &mut ChaCha8Rng::seed_from_u64(SEED);
        let effects: Vec<Effect> = match self {
            Self::Nothing => Vec::new(),
            Self::One => vec![draw_effect("static_friction", &machine, rng)],
            Self::Two => {
                ["static_friction", "spring"].map(|id| draw_effect(id, &machine, rng)).to_vec()
            }
            Self::Outsider => vec![draw_outsider("cubic_drag", &machine, rng)],
        };
        Draw { effects, ..machine }
    }
}

/// Measures a machine, with noise from a fixed seed.
///
/// # Panics
/// If the machine has no measurement; each of this module has one.
pub fn measured(machine: &Draw) -> Measurement {
    measure(machine, SEED).expect("a machine that moves")
}

/// A request that says the order of the machine's actuator and nothing else.
pub fn order_given(machine: &Draw) -> IdentifyRequest {
    let actuator_order = machine.plant.actuator.order();
    IdentifyRequest { plant: Some(PlantRequest { actuator_order }), ..IdentifyRequest::default() }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Verdict;
    use servoscope_core::diagnose::diagnose;
    use servoscope_core::observer::Silent;

    use super::*;

    #[test]
    #[ignore = "slow: four diagnoses"]
    fn a_diagnosis_of_each_table_is_of_its_kind() {
        for (name, hidden) in Hidden::ALL {
            let machine = hidden.machine();
            let measurement = measured(&machine);
            let shape = measurement.experiments().iter().map(|e| e.response.len());
            assert_eq!(shape.collect::<Vec<_>>(), [8; 48], "{name}");
            let found = diagnose(&measurement, &order_given(&machine), &Silent).unwrap();
            let mut causes: Vec<&str> = found.causes.iter().map(|c| c.effect.as_str()).collect();
            causes.sort_unstable();
            match hidden {
                Hidden::Nothing => assert_eq!(found.verdict, Verdict::Adequate),
                Hidden::One => assert_eq!(causes, ["static_friction"]),
                Hidden::Two => assert_eq!(causes, ["spring", "static_friction"]),
                Hidden::Outsider => {
                    assert!(!matches!(found.verdict, Verdict::Adequate | Verdict::Explained));
                }
            }
        }
    }
}
