//! Measurements of a draw.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::Draw;
use crate::machines::noise::RelativeNoise;
use crate::machines::responses::Responses;
use crate::machines::simulator::{Settings, SimulatorError};
use crate::measurement::{InvalidMeasurement, Measurement};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::draw::{NoiseStatement, draw};
    use crate::machines::simulator::Effect;
    use crate::measurement::Complex;
    use crate::plant::{Actuator, Friction, Plant};

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
