//! A test bench that is not there: the exact response, measured with noise.

mod error;
mod response;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use servoscope_bench::machines::draw::{NoiseStatement, noise_std, observe};
use servoscope_core::effects::ActiveEffect;
use servoscope_core::measurement::{
    Complex, Experiment, Measurement, Metadata, Quantity, ResponseKind,
};
use servoscope_core::plant::{Friction, Plant};

use response::input;

pub(super) use error::BenchError;

/// How noisy a measurement is: the standard deviation of re and im of every
/// harmonic, of re alone of harmonic 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Noise {
    /// Not at all.
    None,
    /// In response units.
    Std(f64),
    /// N for median|Y₁|·10^(−N/20), the median over all experiments.
    Decibels(f64),
}

/// An axis and how it is measured.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bench {
    pub plant: Plant,
    /// What the axis has beyond it.
    pub effects: Vec<ActiveEffect>,
    /// Input units.
    pub magnitudes: Vec<f64>,
    /// Each measured at every magnitude.
    pub frequencies_rad_s: Vec<f64>,
    /// Highest harmonic.
    pub harmonics: usize,
    pub response: ResponseKind,
    pub input_unit: String,
    pub response_unit: String,
    pub noise: Noise,
    /// Repeats to write in place of the deviation; each scatters √M more.
    pub repeats: Option<usize>,
    pub seed: u64,
}

/// One experiment, simulated.
struct Point {
    magnitude: f64,
    omega_rad_s: f64,
    run: usize,
    /// Constant input, input units.
    offset: f64,
    /// Y₀ …, response units.
    response: Vec<Complex>,
}

impl Bench {
    /// Simulates every experiment and adds the noise. Beside the measurement, why an
    /// experiment without a periodic response is not in it.
    pub(super) fn measure(&self) -> Result<(Measurement, Vec<BenchError>), BenchError> {
        let design: Vec<(f64, f64)> = self
            .magnitudes
            .iter()
            .flat_map(|m| self.frequencies_rad_s.iter().map(move |omega| (*m, *omega)))
            .collect();
        let last_run = design.len().saturating_sub(1).max(1) as f64;
        let simulated: Vec<Result<Point, BenchError>> = design
            .par_iter()
            .enumerate()
            .map(|(run, &(magnitude, omega_rad_s))| {
                let share = run as f64 / last_run;
                let (offset, response) = self.respond(share, magnitude, omega_rad_s)?;
                Ok(Point { magnitude, omega_rad_s, run, offset, response })
            })
            .collect();
        let (mut points, mut left_out) = (Vec::new(), Vec::new());
        for point in simulated {
            match point {
                Ok(point) => points.push(point),
                Err(error) if error.concerns_one_point() => left_out.push(error),
                Err(error) => return Err(error),
            }
        }
        if points.is_empty() && !left_out.is_empty() {
            return Err(BenchError::Nothing { first: Box::new(left_out.swap_remove(0)) });
        }
        let responses: Vec<Vec<Complex>> =
            points.iter().map(|point| point.response.clone()).collect();
        let std = match self.noise {
            Noise::None => None,
            Noise::Std(std) => Some(std),
            Noise::Decibels(decibels) => {
                let Friction { fs_plus, fs_minus, .. } = self.plant.friction;
                let still = BenchError::Still { level: fs_plus.max(fs_minus) };
                Some(noise_std(&responses, decibels).ok_or(still)?)
            }
        };
        let statement = self.repeats.map_or(NoiseStatement::Std, NoiseStatement::Repeats);
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let experiments = points
            .iter()
            .map(|point| {
                let (mut response, mut repeats) = observe(&point.response, std, statement, rng);
                if self.response != ResponseKind::Velocity {
                    // The mean of a position or an acceleration says nothing.
                    response.remove(0);
                    for repeat in &mut repeats {
                        repeat.response.remove(0);
                    }
                }
                Experiment {
                    magnitude: point.magnitude,
                    omega_rad_s: point.omega_rad_s,
                    input: input(point.offset, point.magnitude),
                    input_mean_measured: point.offset != 0.0,
                    mean_velocity: 0.0,
                    rounding_std: 0.0,
                    open_samples: None,
                    bad_samples: None,
                    clipping: None,
                    range: None,
                    unknown_input: Vec::new(),
                    response,
                    run: Some(point.run as f64),
                    repeats,
                    from_record: false,
                }
            })
            .collect();
        // No bytes were read, so there is nothing to take a digest of.
        let measurement =
            Measurement::new(self.metadata(), experiments, Vec::new(), String::new())?;
        Ok((measurement, left_out))
    }

    fn metadata(&self) -> Metadata {
        let quantity = |name: &str, unit: &str| match unit {
            "" => Quantity::default(),
            unit => Quantity { name: name.to_owned(), unit: unit.to_owned() },
        };
        let response = match self.response {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        };
        Metadata {
            name: Some("simulated axis".into()),
            input: quantity("command", &self.input_unit),
            response: quantity(response, &self.response_unit),
            response_kind: self.response,
            ..Metadata::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::plant::Actuator;

    use super::*;

    pub(super) fn bench() -> Bench {
        Bench {
            plant: Plant {
                viscous_rate_rad_s: 10.0,
                constant: 10.0,
                actuator: Actuator::Direct,
                friction: Friction::coulomb(0.5, 0.4),
            },
            effects: Vec::new(),
            magnitudes: vec![1.0, 2.0, 4.0],
            frequencies_rad_s: vec![1.0, 3.0, 10.0, 30.0, 100.0],
            harmonics: 7,
            response: ResponseKind::Velocity,
            input_unit: String::new(),
            response_unit: String::new(),
            noise: Noise::None,
            repeats: None,
            seed: 1,
        }
    }

    fn noise(noisy: &Bench) -> Vec<f64> {
        let exact =
            Bench { noise: Noise::None, repeats: None, ..noisy.clone() }.measure().unwrap().0;
        let noisy = noisy.measure().unwrap().0;
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

    #[test]
    fn noise_is_as_stated_and_told_by_deviations_or_by_repeats() {
        for repeats in [None, Some(6)] {
            let bench = Bench { noise: Noise::Std(0.01), repeats, ..bench() };
            let values = noise(&bench);
            let rms = (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
            // The rms of n normals is known to 1/√(2n); four of that.
            let margin = 4.0 / (2.0 * values.len() as f64).sqrt();
            assert!((rms / 0.01 - 1.0).abs() < margin, "{rms} with {repeats:?} repeats");
            for experiment in bench.measure().unwrap().0.experiments() {
                assert_eq!(experiment.repeats.len(), repeats.unwrap_or(0));
                assert_eq!(experiment.std_given(), repeats.is_none());
            }
        }
    }

    #[test]
    fn decibels_are_below_the_median_fundamental_of_the_response_as_measured() {
        for response in [ResponseKind::Velocity, ResponseKind::Position] {
            let bench = Bench { response, ..bench() };
            let exact = bench.measure().unwrap().0;
            let mut sizes: Vec<f64> =
                exact.experiments().iter().map(|e| e.harmonic(1).unwrap().value.norm()).collect();
            sizes.sort_by(f64::total_cmp);
            let noisy = Bench { noise: Noise::Decibels(40.0), ..bench }.measure().unwrap().0;
            let std = noisy.experiments()[0].response[0].std.unwrap();
            assert!((std / (0.01 * sizes[7]) - 1.0).abs() < 1e-12, "{std}");
        }
    }

    #[test]
    fn decibels_below_nothing_are_refused() {
        let still = Bench { magnitudes: vec![0.1, 0.2], noise: Noise::Decibels(60.0), ..bench() };
        assert_eq!(still.measure().unwrap_err(), BenchError::Still { level: 0.5 });
        assert!(Bench { noise: Noise::None, ..still }.measure().is_ok());
    }

    #[test]
    fn the_same_seed_gives_the_same_measurement_and_another_one_does_not() {
        let bench = Bench { noise: Noise::Decibels(60.0), ..bench() };
        assert_eq!(bench.measure(), bench.measure());
        assert_ne!(bench.measure(), Bench { seed: 2, ..bench.clone() }.measure());
    }
}
