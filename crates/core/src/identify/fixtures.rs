//! Measurements for the tests of this module, made by the independent simulator.

use crate::machines::simulator::{self, Machine, Settings};
use crate::measurement::{Complex, Experiment, Harmonic, Measurement, Metadata};
use crate::plant::{Actuator, Friction, Plant};

/// An axis with a = 10 1/s, K = 10, Fc⁺ = 0.5 and Fc⁻ = 0.4.
pub(super) fn axis(actuator: Actuator) -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    }
}

/// One actuator of each order.
pub(super) const ACTUATORS: [Actuator; 3] = [
    Actuator::Direct,
    Actuator::FirstOrder { corner_rad_s: 25.0 },
    Actuator::SecondOrder { natural_frequency_rad_s: 40.0, damping_ratio: 0.3 },
];

/// Cosines at two magnitudes, 2 and 4, and eight frequencies; harmonics 0 to `highest`.
pub(super) fn stepped_sine(plant: &Plant, highest: usize) -> Measurement {
    let design = [2.0, 4.0].into_iter().flat_map(|magnitude| {
        (0..8).map(move |i| (magnitude, 2.0 * 40.0_f64.powf(f64::from(i) / 7.0)))
    });
    let experiments = design.map(|(magnitude, omega)| {
        let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
        experiment(plant, omega, magnitude, input, highest)
    });
    joined(experiments.collect())
}

/// One multisine of 30 lines between 1 and 30 rad/s.
pub(super) fn multisine(plant: &Plant) -> Measurement {
    let mut input = vec![Complex::new(0.0, 0.0)];
    input.extend((1..=30).map(|k| Complex::from_polar(0.6, f64::from(k * k))));
    joined(vec![experiment(plant, 1.0, 10.0, input, 30)])
}

/// A measurement of these experiments.
pub(super) fn joined(experiments: Vec<Experiment>) -> Measurement {
    Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap()
}

fn experiment(
    plant: &Plant,
    omega_rad_s: f64,
    magnitude: f64,
    input: Vec<Complex>,
    highest: usize,
) -> Experiment {
    let settings = Settings::default();
    let machine = Machine::base(*plant);
    let velocity =
        simulator::respond(&machine, 0.0, omega_rad_s, &input, highest, &settings).unwrap();
    let harmonic = |(order, value)| Harmonic { order, value, std: None };
    Experiment {
        magnitude,
        omega_rad_s,
        input,
        input_mean_measured: false,
        mean_velocity: 0.0,
        rounding_std: 0.0,
        open_samples: None,
        bad_samples: None,
        clipping: None,
        range: None,
        unknown_input: Vec::new(),
        response: velocity.into_iter().enumerate().map(harmonic).collect(),
        run: None,
        repeats: Vec::new(),
        from_record: false,
    }
}
