//! A periodic input, prepared once for many simulations.

use std::fmt;
use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use crate::measurement::{Complex, Experiment};
use crate::plant::Actuator;

/// Samples per period and highest line, at least: the torque is interpolated
/// between samples by polynomials of degree 5, whose error for a line with n
/// samples per period is (2π/n)⁶/46080, 5e-6 of that line at the least n.
const SAMPLES_PER_HIGHEST_CYCLE: usize = 8;

/// Fewest samples a period of a general input is divided into.
const FEWEST_SAMPLES: usize = 512;

/// A periodic input u(t) = Re Σ Uₖ exp(jkωt), prepared for simulation.
#[derive(Clone)]
pub struct Excitation {
    omega_rad_s: f64,
    input: Vec<Complex>,
    pure_cosine: bool,
    fft: Option<Arc<dyn Fft<f64>>>,
}

impl Excitation {
    /// Prepares u(t) = Re Σ Uₖ exp(jkωt); `input` holds U₀, U₁ …
    pub fn new(omega_rad_s: f64, input: Vec<Complex>) -> Self {
        let zero = Complex::new(0.0, 0.0);
        let pure_cosine =
            input.len() > 1 && input.iter().enumerate().all(|(k, u)| k == 1 || *u == zero);
        let fft = (!pure_cosine).then(|| {
            let samples = (SAMPLES_PER_HIGHEST_CYCLE * input.len().saturating_sub(1))
                .max(FEWEST_SAMPLES)
                .next_power_of_two();
            FftPlanner::new().plan_fft_inverse(samples)
        });
        Self { omega_rad_s, input, pure_cosine, fft }
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
        self.pure_cosine
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

    /// Inverse transform of the sampling grid; only for general inputs.
    pub(super) fn fft(&self) -> Option<&Arc<dyn Fft<f64>>> {
        self.fft.as_ref()
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
