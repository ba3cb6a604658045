//! Noise-free responses of a drawn machine, and measurements made of them.

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::draw::{Draw, DrawError, NoiseStatement, noise_std, observe};
use super::simulator::{Machine, Settings, SimulatorError, respond};
use crate::measurement::{Complex, Experiment, Harmonic, Measurement, Metadata, Repeat};

/// Noise-free responses of the experiments of a design, in the order of acquisition.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    points: Vec<Point>,
    /// Y₀ … Y_H of each point.
    responses: Vec<Vec<Complex>>,
}

/// An experiment that has a response.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    /// Index in the design.
    run: usize,
    magnitude: f64,
    omega_rad_s: f64,
}

impl Responses {
    /// Simulates every experiment of a draw. Experiments without a response of the input's period
    /// are left out; the others keep their run number.
    ///
    /// # Errors
    /// [`DrawError::Simulator`].
    pub fn simulate(draw: &Draw, settings: &Settings) -> Result<Self, DrawError> {
        let machine = Machine { plant: draw.plant, effects: &draw.effects };
        let last_run = draw.design.len().saturating_sub(1).max(1);
        let simulate = |(run, &(magnitude, omega_rad_s)): (usize, &(f64, f64))| {
            let share = run as f64 / last_run as f64;
            let input = cosine(magnitude);
            match respond(&machine, share, omega_rad_s, &input, draw.harmonics, settings) {
                Ok(response) => Ok(Some((Point { run, magnitude, omega_rad_s }, response))),
                Err(SimulatorError::NotPeriodic { .. }) => Ok(None),
                Err(source) => Err(DrawError::Simulator { magnitude, omega_rad_s, source }),
            }
        };
        let found =
            draw.design.par_iter().enumerate().map(simulate).collect::<Result<Vec<_>, _>>()?;
        let (points, responses) = found.into_iter().flatten().unzip();
        Ok(Self { points, responses })
    }

    /// Number of experiments that have a response.
    pub fn experiments(&self) -> usize {
        self.points.len()
    }

    /// The standard deviation that "N dB" means, response units: median|Y₁|·10^(−N/20).
    ///
    /// # Errors
    /// [`DrawError::Still`] if at least half of the experiments are stuck.
    pub fn noise_std(&self, noise_db: f64) -> Result<f64, DrawError> {
        noise_std(&self.responses, noise_db).ok_or(DrawError::Still)
    }

    /// The measurement without noise. `std`, if given, is the standard deviation that it states.
    ///
    /// # Errors
    /// [`DrawError::Invalid`] if no experiment has a response.
    pub fn exact(&self, std: Option<f64>) -> Result<Measurement, DrawError> {
        measurement(self.measured(|response| {
            let harmonic = |(order, &value)| Harmonic { order, value, std };
            (response.iter().enumerate().map(harmonic).collect(), Vec::new())
        }))
    }

    /// The measurement with noise of N dB.
    ///
    /// # Errors
    /// [`DrawError::Still`], [`DrawError::Invalid`].
    pub fn noisy(
        &self,
        noise_db: f64,
        statement: NoiseStatement,
        rng: &mut ChaCha8Rng,
    ) -> Result<Measurement, DrawError> {
        measurement(self.experiments_with(self.noise_std(noise_db)?, statement, rng))
    }

    /// The experiments with noise of standard deviation `std`, response units. Their `run` is
    /// their index in the design.
    pub fn experiments_with(
        &self,
        std: f64,
        statement: NoiseStatement,
        rng: &mut ChaCha8Rng,
    ) -> Vec<Experiment> {
        self.measured(|response| observe(response, Some(std), statement, rng))
    }

    fn measured(
        &self,
        mut observe_response: impl FnMut(&[Complex]) -> (Vec<Harmonic>, Vec<Repeat>),
    ) -> Vec<Experiment> {
        let experiment = |(point, response): (&Point, &Vec<Complex>)| {
            let (response, repeats) = observe_response(response);
            Experiment {
                magnitude: point.magnitude,
                omega_rad_s: point.omega_rad_s,
                input: cosine(point.magnitude),
                input_mean_measured: false,
                response,
                run: Some(point.run as f64),
                repeats,
                from_record: false,
            }
        };
        self.points.iter().zip(&self.responses).map(experiment).collect()
    }
}

/// Makes the measurement, with an empty digest because it was not read from a file.
fn measurement(experiments: Vec<Experiment>) -> Result<Measurement, DrawError> {
    Ok(Measurement::new(Metadata::default(), experiments, Vec::new(), String::new())?)
}

fn cosine(magnitude: f64) -> Vec<Complex> {
    vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)]
}
