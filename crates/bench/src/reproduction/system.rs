//! The two systems of the paper, and how they are measured here.

use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};

use crate::machines::draw::{Draw, NoiseStatement};

/// Parameter values by the names used in answers.
pub(super) type Values = indexmap::IndexMap<String, f64>;

/// A system of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    /// G₁(s) = 10/(s + 10), equation 12.
    G1,
    /// G₂(s) = 10000/((s + 10)(s² + 5s + 1000)), equation 13.
    G2,
}

/// Number of frequencies of the design, at each of two magnitudes.
pub(super) const FREQUENCIES: usize = 13;

/// The two magnitudes, input units: 4 and 8 times the larger Coulomb level, where a describing
/// function is accurate enough for the closed form. The paper does not state its magnitudes.
pub const MAGNITUDES: [f64; 2] = [2.0, 4.0];

/// Highest harmonic measured.
pub(super) const HARMONICS: usize = 9;

impl System {
    /// Both systems.
    pub const ALL: [System; 2] = [System::G1, System::G2];

    /// `G1`, `G2`.
    pub fn name(self) -> &'static str {
        match self {
            System::G1 => "G1",
            System::G2 => "G2",
        }
    }

    /// Order of the actuator, which the paper assumes to be known.
    pub fn actuator_order(self) -> u8 {
        match self {
            System::G1 => 0,
            System::G2 => 2,
        }
    }

    /// The system, with friction acting on the mechanics behind the actuator.
    pub fn plant(self) -> Plant {
        let actuator = match self {
            System::G1 => Actuator::Direct,
            System::G2 => Actuator::SecondOrder {
                natural_frequency_rad_s: 1000.0_f64.sqrt(),
                damping_ratio: 2.5 / 1000.0_f64.sqrt(),
            },
        };
        Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator,
            friction: Friction::coulomb(0.5, 0.4),
        }
    }

    /// Lowest and highest frequency of the design, rad/s: a decade on each side of the pole for G1,
    /// and up to 2.5 times the resonance for G2. The paper does not state its frequencies.
    pub fn band_rad_s(self) -> [f64; 2] {
        match self {
            System::G1 => [1.0, 100.0],
            System::G2 => [1.0, 80.0],
        }
    }

    /// The machine and its design: both magnitudes at every frequency, harmonics 0 to 9.
    pub(super) fn draw(self) -> Draw {
        let [low, high] = self.band_rad_s();
        let omega = |i| low * (high / low).powf(f64::from(i) / (FREQUENCIES - 1) as f64);
        let design = MAGNITUDES.into_iter();
        let design = design.flat_map(|m| (0..FREQUENCIES as u32).map(move |i| (m, omega(i))));
        Draw {
            plant: self.plant(),
            effects: Vec::new(),
            design: design.collect(),
            harmonics: HARMONICS,
            noise_db: None,
            noise_statement: NoiseStatement::Std,
        }
    }

    /// Exact values of the rows of the paper's table, computed from the equation of the system.
    pub fn targets(self) -> Vec<Complex> {
        self.rows(&reported(&self.plant()))
    }

    /// The rows of the paper's table except N_T, from named parameters: pole, constant and DC gain
    /// (G1), or three roots and DC gain (G2), then Fc⁺ and Fc⁻.
    pub(super) fn rows(self, values: &Values) -> Vec<Complex> {
        let real = |name: &str| Complex::new(values[name], 0.0);
        let ends = ["dc_gain", "fc_plus", "fc_minus"].map(real);
        let begin = match self {
            System::G1 => vec![real("pole"), real("constant")],
            System::G2 => {
                let (omega, zeta) = (values["natural_frequency"], values["damping_ratio"]);
                let root = Complex::new(1.0 - zeta * zeta, 0.0).sqrt() * Complex::new(0.0, omega);
                let middle = Complex::new(-zeta * omega, 0.0);
                vec![middle + root, middle - root, real("pole")]
            }
        };
        begin.into_iter().chain(ends).collect()
    }

    /// The plant with the given named parameters.
    pub(super) fn identified(self, values: &Values) -> Plant {
        let actuator = match self {
            System::G1 => Actuator::Direct,
            System::G2 => Actuator::SecondOrder {
                natural_frequency_rad_s: values["natural_frequency"],
                damping_ratio: values["damping_ratio"],
            },
        };
        Plant {
            viscous_rate_rad_s: -values["pole"],
            constant: values["constant"],
            actuator,
            friction: Friction::coulomb(values["fc_plus"], values["fc_minus"]),
        }
    }
}

/// The parameters of a plant by the names used in answers.
pub(super) fn reported(plant: &Plant) -> Values {
    let (a, k) = (plant.viscous_rate_rad_s, plant.constant);
    let mut values: Values = [
        ("pole", -a),
        ("constant", k),
        ("dc_gain", k / a),
        ("fc_plus", plant.friction.fc_plus),
        ("fc_minus", plant.friction.fc_minus),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into_iter()
    .collect();
    if let Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } = plant.actuator {
        values.insert("natural_frequency".into(), natural_frequency_rad_s);
        values.insert("damping_ratio".into(), damping_ratio);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_targets_are_the_roots_of_equation_13_and_not_those_printed() {
        let targets = System::G2.targets();
        // The first two are roots of s² + 5s + 1000, the third of s + 10.
        for root in &targets[..2] {
            assert!((root * root + 5.0 * root + 1000.0).norm() < 1e-9, "{root}");
        }
        assert!((targets[0].im - 31.5238).abs() < 5e-5 && targets[0].im > targets[1].im);
        assert_eq!(targets[2].re, -10.0);
        assert_eq!(System::G1.targets().len(), 5);
    }

    #[test]
    fn a_plant_is_restored_from_its_reported_parameters() {
        for system in System::ALL {
            assert_eq!(system.identified(&reported(&system.plant())), system.plant());
        }
    }
}
