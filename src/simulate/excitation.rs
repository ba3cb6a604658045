//! A periodic input, prepared once for many simulations.

use std::fmt;
use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use crate::measurement::{Complex, Experiment};
use crate::plant::Actuator;

/// Samples per period and highest line, at least: see `samples` for the error.
const SAMPLES_PER_HIGHEST_CYCLE: usize = 12;

/// Fewest samples a period of a general input is divided into.
const FEWEST_SAMPLES: usize = 1024;

/// A uniform grid over one period, with its transforms.
#[derive(Clone)]
pub(super) struct Grid {
    inverse: Arc<dyn Fft<f64>>,
    forward: Arc<dyn Fft<f64>>,
}

impl Grid {
    fn new(highest_line: usize) -> Self {
        let samples = (SAMPLES_PER_HIGHEST_CYCLE * highest_line).max(FEWEST_SAMPLES);
        let samples = next_quick_length(samples);
        let mut planner = FftPlanner::new();
        Self {
            inverse: planner.plan_fft_inverse(samples),
            forward: planner.plan_fft_forward(samples),
        }
    }

    /// Samples of a period.
    pub fn samples(&self) -> usize {
        self.forward.len()
    }

    /// Lines to samples, in place, without scaling.
    pub fn inverse(&self, signal: &mut [Complex]) {
        self.inverse.process(signal);
    }

    /// Samples to Σ x exp(−jkωt), in place, without scaling.
    pub fn forward(&self, signal: &mut [Complex]) {
        self.forward.process(signal);
    }
}

/// The next length that has no prime factor above 5: transforms of it are quick.
fn next_quick_length(at_least: usize) -> usize {
    let left_over = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n
    };
    (at_least..).find(|n| left_over(*n) == 1).expect("a power of two comes sooner or later")
}

/// A periodic input u(t) = Re Σ Uₖ exp(jkωt), prepared for simulation.
#[derive(Clone)]
pub struct Excitation {
    omega_rad_s: f64,
    input: Vec<Complex>,
    grid: Option<Grid>,
}

impl Excitation {
    /// Prepares u(t) = Re Σ Uₖ exp(jkωt); `input` holds U₀, U₁ …
    pub fn new(omega_rad_s: f64, input: Vec<Complex>) -> Self {
        let zero = Complex::new(0.0, 0.0);
        let pure_cosine =
            input.len() > 1 && input.iter().enumerate().all(|(k, u)| k == 1 || *u == zero);
        let grid = (!pure_cosine).then(|| Grid::new(input.len().saturating_sub(1)));
        Self { omega_rad_s, input, grid }
    }

    /// A pure cosine m·cos(ωt).
    pub fn cosine(omega_rad_s: f64, magnitude: f64) -> Self {
        Self::new(omega_rad_s, vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)])
    }

    /// Fundamental, rad/s.
    pub fn omega_rad_s(&self) -> f64 {
        self.omega_rad_s
    }

    /// U₀, U₁ …, input units.
    pub fn input(&self) -> &[Complex] {
        &self.input
    }

    /// Whether the fundamental is all there is.
    pub fn is_pure_cosine(&self) -> bool {
        self.grid.is_none()
    }

    /// Period, seconds.
    pub fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.omega_rad_s
    }

    /// Tₗ = A(jlω)·Uₗ: the torque behind the actuator.
    pub(super) fn torque_lines(&self, actuator: &Actuator) -> Vec<Complex> {
        self.through(actuator, &self.input)
    }

    /// A(jlω)·Xₗ for any lines of the same fundamental.
    pub(super) fn through(&self, actuator: &Actuator, lines: &[Complex]) -> Vec<Complex> {
        lines
            .iter()
            .enumerate()
            .map(|(l, x)| x * actuator.response(l as f64 * self.omega_rad_s))
            .collect()
    }

    /// The sampling grid; only general inputs have one.
    pub(super) fn grid(&self) -> Option<&Grid> {
        self.grid.as_ref()
    }
}

impl From<&Experiment> for Excitation {
    fn from(experiment: &Experiment) -> Self {
        Self::new(experiment.omega_rad_s, experiment.input.clone())
    }
}

impl fmt::Debug for Excitation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Excitation")
            .field("omega_rad_s", &self.omega_rad_s)
            .field("lines", &self.input.len())
            .finish_non_exhaustive()
    }
}
