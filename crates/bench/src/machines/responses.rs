//! Noise-free responses of a drawn machine, and measurements made of them.

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::draw::{Draw, DrawError};
use super::noise::{NoiseLaw, NoiseStatement, RelativeNoise, silent};
use super::simulator::{Machine, Settings, SimulatorError, respond};
use crate::measurement::{Complex, Experiment, Harmonic, Measurement, Metadata, Repeat};

/// Noise-free responses of the experiments of a design, in the order of acquisition.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    points: Vec<Point>,
    /// Y₀ … Y_H of each point.
    responses: Vec<Vec<Complex>>,
    /// Whether measurements contain Y₀.
    with_means: bool,
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
        Ok(Self { points, responses, with_means: true })
    }

    /// Number of experiments that have a response.
    pub fn experiments(&self) -> usize {
        self.points.len()
    }

    /// The same, but without harmonic 0 in the measurements.
    pub fn without_means(self) -> Self {
        Self { with_means: false, ..self }
    }

    /// The law of noise relative to these responses.
    ///
    /// # Errors
    /// [`DrawError::Still`] if at least half of the experiments are stuck.
    pub fn law(&self, noise: &RelativeNoise) -> Result<NoiseLaw, DrawError> {
        noise.law(&self.responses).ok_or(DrawError::Still)
    }

    /// The measurement without noise. `std`, if given, is the standard deviation that it states of
    /// every harmonic, response units.
    ///
    /// # Errors
    /// [`DrawError::Invalid`] if no experiment has a response.
    pub fn exact(&self, std: Option<f64>) -> Result<Measurement, DrawError> {
        match std {
            Some(std) => self.stating(&NoiseLaw::uniform(std)),
            None => measurement(self.measured(|response| (silent(response), Vec::new()))),
        }
    }

    /// The measurement without noise, which states the standard deviations of this law.
    ///
    /// # Errors
    /// [`DrawError::Invalid`] if no experiment has a response.
    pub fn stating(&self, law: &NoiseLaw) -> Result<Measurement, DrawError> {
        measurement(self.measured(|response| (law.stated(response), Vec::new())))
    }

    /// The measurement with noise.
    ///
    /// # Errors
    /// [`DrawError::Still`], [`DrawError::Invalid`].
    pub fn noisy(
        &self,
        noise: &RelativeNoise,
        statement: NoiseStatement,
        rng: &mut ChaCha8Rng,
    ) -> Result<Measurement, DrawError> {
        measurement(self.experiments_with(&self.law(noise)?, statement, rng))
    }

    /// The experiments with noise of this law. Their `run` is their index in the design.
    pub fn experiments_with(
        &self,
        law: &NoiseLaw,
        statement: NoiseStatement,
        rng: &mut ChaCha8Rng,
    ) -> Vec<Experiment> {
        self.measured(|response| law.observe(response, statement, rng))
    }

    fn measured(
        &self,
        mut observe_response: impl FnMut(&[Complex]) -> (Vec<Harmonic>, Vec<Repeat>),
    ) -> Vec<Experiment> {
        let experiment = |(point, response): (&Point, &Vec<Complex>)| {
            let (mut response, mut repeats) = observe_response(response);
            if !self.with_means {
                response.remove(0);
                for repeat in &mut repeats {
                    repeat.response.remove(0);
                }
            }
            Experiment {
                magnitude: point.magnitude,
                omega_rad_s: point.omega_rad_s,
                input: cosine(point.magnitude),
                input_mean_measured: false,
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
