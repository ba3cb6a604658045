//! Draws random machines and experiment designs, and makes measurements of them.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub use super::noise::{NoiseStatement, noise_std, observe};

use super::noise::RelativeNoise;
use super::responses::Responses;
use super::simulator::{Effect, Settings, SimulatorError};
use crate::measurement::{InvalidMeasurement, Measurement};
use crate::plant::{Actuator, Friction, Plant};

/// Number of magnitudes of a drawn design.
const MAGNITUDES: usize = 3;
/// Number of its frequencies at each magnitude.
const FREQUENCIES: usize = 16;

/// A machine and how it is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// The base model of the machine.
    pub plant: Plant,
    /// Effects beyond the base model.
    pub effects: Vec<Effect>,
    /// Magnitude (input units) and fundamental (rad/s) of each experiment.
    pub design: Vec<(f64, f64)>,
    /// Highest harmonic measured.
    pub harmonics: usize,
    /// N of "N dB": re and im of every harmonic have a standard deviation of median|Y₁|·10^(−N/20),
    /// with the median over all experiments. `None`: no noise, and none stated.
    pub noise_db: Option<f64>,
    /// How the measurement states its noise.
    pub noise_statement: NoiseStatement,
}

/// Why no measurement can be made of a draw.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DrawError {
    /// An experiment could not be simulated.
    #[error("magnitude {magnitude} at {omega_rad_s} rad/s: {source}")]
    Simulator {
        /// Magnitude of the experiment, input units.
        magnitude: f64,
        /// Its fundamental, rad/s.
        omega_rad_s: f64,
        /// The error of the simulator.
        source: SimulatorError,
    },
    /// At least half of the experiments are stuck, so the median response that sets the noise level
    /// is 0.
    #[error("the median fundamental is 0: noise cannot be relative to it")]
    Still,
    /// The measurement is invalid.
    #[error(transparent)]
    Invalid(#[from] InvalidMeasurement),
}

/// Draws a machine whose actuator has the given order (0, 1 or 2), and a stepped-sine design for
/// it with a noise of 60 dB, stated as standard deviations.
///
/// | quantity | range |
/// | --- | --- |
/// | a | 2 … 50 1/s, log-uniform |
/// | K/a | 0.2 … 5 response units per input unit, log-uniform |
/// | (Fc⁺ + Fc⁻)/2 | 0.1 … 2 input units, log-uniform |
/// | Fc⁺ − Fc⁻ | ± 30 % of that, uniform |
/// | p, order 1 | 1 … 8 a, log-uniform |
/// | ωₙ, order 2 | 2 … 8 a, log-uniform |
/// | ζ, order 2 | 0.05 … 0.7, log-uniform |
/// | lowest magnitude | 1.9 … 2.6 times the larger Coulomb level, uniform; then × 2 and × 4 |
/// | frequencies | 16, log-spaced from 0.15 a to 10 a (2.5 ωₙ at order 2) |
///
/// The static level is the Coulomb level, harmonics are 0 to 7.
///
/// # Panics
/// If the order is above 2.
pub fn draw(actuator_order: u8, seed: u64) -> Draw {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let a = log_uniform(2.0, 50.0, rng);
    let constant = a * log_uniform(0.2, 5.0, rng);
    let level = log_uniform(0.1, 2.0, rng);
    let half_difference = 0.5 * level * rng.random_range(-0.3..=0.3);
    let friction = Friction::coulomb(level + half_difference, level - half_difference);
    let actuator = match actuator_order {
        0 => Actuator::Direct,
        1 => Actuator::FirstOrder { corner_rad_s: a * log_uniform(1.0, 8.0, rng) },
        2 => Actuator::SecondOrder {
            natural_frequency_rad_s: a * log_uniform(2.0, 8.0, rng),
            damping_ratio: log_uniform(0.05, 0.7, rng),
        },
        order => panic!("no actuator has order {order}"),
    };
    let highest_rad_s = match actuator {
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => 2.5 * natural_frequency_rad_s,
        _ => 10.0 * a,
    };
    let lowest_rad_s = 0.15 * a;
    let lowest_magnitude = friction.fc_plus.max(friction.fc_minus) * rng.random_range(1.9..=2.6);
    let band_rad_s = [lowest_rad_s, highest_rad_s];
    let design = stepped_sine(lowest_magnitude, MAGNITUDES, band_rad_s, FREQUENCIES);
    Draw {
        plant: Plant { viscous_rate_rad_s: a, constant, actuator, friction },
        effects: Vec::new(),
        design,
        harmonics: 7,
        noise_db: Some(60.0),
        noise_statement: NoiseStatement::Std,
    }
}

/// A design of magnitudes that double, from the lowest one (input units), each at the same
/// frequencies (at least 2), log-spaced over a band (rad/s).
pub fn stepped_sine(
    lowest_magnitude: f64,
    magnitudes: usize,
    band_rad_s: [f64; 2],
    frequencies: usize,
) -> Vec<(f64, f64)> {
    let [lowest_rad_s, highest_rad_s] = band_rad_s;
    let at = |index: usize| {
        let share = index as f64 / (frequencies - 1) as f64;
        lowest_rad_s * (highest_rad_s / lowest_rad_s).powf(share)
    };
    let factors = (0..magnitudes).map(|index| 2.0_f64.powi(index as i32));
    factors
        .flat_map(|factor| (0..frequencies).map(move |i| (factor * lowest_magnitude, at(i))))
        .collect()
}

/// Simulates every experiment of a draw, in the order of acquisition, and adds random noise from
/// `seed`. Experiments without a response of the input's period are left out; the others keep their
/// run number.
///
/// # Errors
/// See [`DrawError`].
pub fn measure(draw: &Draw, seed: u64) -> Result<Measurement, DrawError> {
    let responses = Responses::simulate(draw, &Settings::default())?;
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    match draw.noise_db {
        Some(noise_db) => {
            responses.noisy(&RelativeNoise::decibels(noise_db), draw.noise_statement, rng)
        }
        None => responses.exact(None),
    }
}

pub(crate) fn log_uniform(low: f64, high: f64, rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random_range(0.0..=1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::Complex;

    fn cheap(noise_db: Option<f64>, noise_statement: NoiseStatement) -> Draw {
        let mut draw = Draw { noise_db, noise_statement, ..draw(0, 5) };
        draw.design.retain(|(_, omega)| *omega > draw.plant.viscous_rate_rad_s);
        draw
    }

    /// Values of `noisy` minus those of `exact`: re and im, without im of the mean.
    fn deviations(noisy: &Measurement, exact: &Measurement) -> Vec<f64> {
        let pairs = noisy.experiments().iter().zip(exact.experiments());
        pairs
            .flat_map(|(noisy, exact)| noisy.response.iter().zip(&exact.response))
            .flat_map(|(noisy, exact)| {
                let difference = noisy.value - exact.value;
                let im = (noisy.order > 0).then_some(difference.im);
                [Some(difference.re), im].into_iter().flatten()
            })
            .collect()
    }

    fn rms(values: &[f64]) -> f64 {
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn machines_and_designs_lie_in_their_ranges() {
        for (order, seed) in (0..3).flat_map(|order| (0..40).map(move |seed| (order, seed))) {
            let Draw { plant, design, harmonics, .. } = draw(order, seed);
            let a = plant.viscous_rate_rad_s;
            assert!((2.0..=50.0).contains(&a));
            let friction = plant.friction;
            let (low, high) =
                (friction.fc_plus.min(friction.fc_minus), friction.fc_plus.max(friction.fc_minus));
            assert!(high - low <= 0.15 * (high + low) + 1e-12);
            assert_eq!(
                (friction.fs_plus, friction.fs_minus),
                (friction.fc_plus, friction.fc_minus)
            );
            assert_eq!((plant.actuator.order(), harmonics, design.len()), (order, 7, 48));
            let [first, last] = [design[0], design[47]];
            assert!((1.9..=2.6).contains(&(first.0 / high)));
            assert!((last.0 / first.0 - 4.0).abs() < 1e-12);
            assert!((first.1 / a - 0.15).abs() < 1e-12);
            let top = match plant.actuator {
                Actuator::SecondOrder { natural_frequency_rad_s: wn, .. } => 2.5 * wn,
                _ => 10.0 * a,
            };
            assert!((last.1 / top - 1.0).abs() < 1e-12);
        }
        assert_ne!(draw(0, 1), draw(0, 2));
    }

    #[test]
    fn noise_of_40_db_is_a_hundredth_of_the_median_fundamental() {
        let exact = measure(&cheap(None, NoiseStatement::Std), 1).unwrap();
        let noisy = measure(&cheap(Some(40.0), NoiseStatement::Std), 1).unwrap();
        let mut fundamentals: Vec<f64> =
            exact.experiments().iter().map(|e| e.response[1].value.norm()).collect();
        fundamentals.sort_by(f64::total_cmp);
        let middle = fundamentals.len() / 2;
        let median = match fundamentals.len() % 2 {
            1 => fundamentals[middle],
            _ => 0.5 * (fundamentals[middle - 1] + fundamentals[middle]),
        };
        let std = noisy.experiments()[0].response[0].std.unwrap();
        assert!((std / (0.01 * median) - 1.0).abs() < 1e-12);
        let scatter = deviations(&noisy, &exact);
        // The rms of n normal values has a relative standard error of 1/√(2n); 4 times that.
        let margin = 4.0 / (2.0 * scatter.len() as f64).sqrt();
        assert!((rms(&scatter) / std - 1.0).abs() < margin);
        assert!(noisy.experiments().iter().all(|e| e.response[0].value.im == 0.0));
        assert!(exact.experiments().iter().flat_map(|e| &e.response).all(|h| h.std.is_none()));
    }

    #[test]
    fn repeats_scatter_so_that_their_mean_is_as_noisy_as_told() {
        let exact = measure(&cheap(None, NoiseStatement::Std), 1).unwrap();
        let told = measure(&cheap(Some(40.0), NoiseStatement::Std), 1).unwrap();
        let repeated = measure(&cheap(Some(40.0), NoiseStatement::Repeats(6)), 2).unwrap();
        let std = told.experiments()[0].response[0].std.unwrap();
        let scatter = deviations(&repeated, &exact);
        let margin = 4.0 / (2.0 * scatter.len() as f64).sqrt();
        assert!((rms(&scatter) / std - 1.0).abs() < margin);

        let mut squares = Vec::new();
        for experiment in repeated.experiments() {
            assert_eq!(experiment.repeats.len(), 6);
            for (k, harmonic) in experiment.response.iter().enumerate() {
                assert_eq!(harmonic.std, None);
                let sum: Complex = experiment.repeats.iter().map(|r| r.response[k]).sum();
                assert!(sum.norm() < 1e-12, "deviations are from the mean");
                squares.extend(experiment.repeats.iter().map(|r| r.response[k].re));
            }
        }
        // Each repeat has a standard deviation of √6·std, so its deviation from the mean of six
        // has √(5/6) times that. Five of the six deviations are independent.
        let margin = 4.0 / (2.0 * squares.len() as f64 * 5.0 / 6.0).sqrt();
        assert!((rms(&squares) / (5.0_f64.sqrt() * std) - 1.0).abs() < margin);
    }

    #[test]
    fn friction_drifts_from_the_first_experiment_to_the_last() {
        let mut drifting = cheap(None, NoiseStatement::Silent);
        drifting.effects = vec![Effect::new("friction_drift", [("delta", 0.3)])];
        let last = drifting.design.len() - 1;
        let drifted = measure(&drifting, 1).unwrap();
        let plain = |factor: f64| {
            let mut draw = cheap(None, NoiseStatement::Silent);
            let Friction { fc_plus, fc_minus, .. } = draw.plant.friction;
            draw.plant.friction = Friction::coulomb(factor * fc_plus, factor * fc_minus);
            measure(&draw, 1).unwrap()
        };
        for (run, factor) in [(0, 1.0), (last, 1.3)] {
            let expected = plain(factor).experiments()[run].response[1].value;
            let found = drifted.experiments()[run].response[1].value;
            assert!((found - expected).norm() < 1e-9 * expected.norm(), "run {run}");
        }
    }

    #[test]
    fn an_experiment_without_a_periodic_response_is_left_out_of_the_run() {
        let mut draw = cheap(None, NoiseStatement::Silent);
        draw.plant = Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(0.5, 0.4),
        };
        // A load on a joint with little damping rattles in its gap for ever; below breakaway it
        // rests.
        let (load_inertia_fraction, stiffness, damping, gap) = (0.5, 200.0, 0.1, 0.01);
        draw.effects = vec![Effect::new(
            "backlash",
            [
                ("load_inertia_fraction", load_inertia_fraction),
                ("stiffness", stiffness),
                ("damping", damping),
                ("gap", gap),
            ],
        )];
        draw.design = vec![(0.2, 20.0), (1.0, 20.0), (0.2, 30.0)];
        let measurement = measure(&draw, 1).unwrap();
        let runs: Vec<_> = measurement.experiments().iter().map(|e| e.run).collect();
        assert_eq!(runs, [Some(0.0), Some(2.0)]);
    }

    #[test]
    fn the_same_seed_gives_the_same_measurement_and_another_one_does_not() {
        let draw = cheap(Some(60.0), NoiseStatement::Silent);
        assert_eq!(measure(&draw, 1), measure(&draw, 1));
        assert_ne!(measure(&draw, 1), measure(&draw, 2));
    }

    #[test]
    fn noise_relative_to_a_stuck_machine_is_refused() {
        let mut draw = cheap(Some(60.0), NoiseStatement::Std);
        for (magnitude, _) in &mut draw.design {
            *magnitude = 0.5 * draw.plant.friction.fc_minus.min(draw.plant.friction.fc_plus);
        }
        assert_eq!(measure(&draw, 1), Err(DrawError::Still));
    }
}
