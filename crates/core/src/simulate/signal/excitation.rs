//! A periodic input, prepared once for many simulations.

use std::fmt;
use std::sync::{Arc, OnceLock};

use rustfft::{Fft, FftPlanner};

use crate::measurement::{Complex, Experiment};
use crate::plant::Actuator;

use super::fourier;

/// Samples per period and highest line, at least: see `samples` for the error.
const SAMPLES_PER_HIGHEST_CYCLE: usize = 12;

/// Fewest samples a period of a general input is divided into.
const FEWEST_SAMPLES: usize = 1024;

/// A uniform grid over one period, with its transforms.
#[derive(Clone)]
pub(crate) struct Grid {
    inverse: Arc<dyn Fft<f64>>,
    forward: Arc<dyn Fft<f64>>,
    tables: Arc<Tables>,
}

/// What does not depend on the signal.
struct Tables {
    /// exp(2πj·n/N), n = 0 … N.
    turns: Vec<Complex>,
    /// ∫₀¹ uⁱ exp(−jθu) du at θ = 2πk/N, for the lowest harmonics.
    moments: Vec<[Complex; 6]>,
}

/// Grids of the ladder: 8, 12, 16, 24 … samples.
const LADDER: usize = 28;

/// Samples of a grid of the ladder.
const fn rung(step: usize) -> usize {
    if step.is_multiple_of(2) { 8 << (step / 2) } else { 12 << (step / 2) }
}

impl Grid {
    fn new(highest_line: usize) -> Self {
        let samples = (SAMPLES_PER_HIGHEST_CYCLE * highest_line).max(FEWEST_SAMPLES);
        Self::of(next_quick_length(samples))
    }

    fn of(samples: usize) -> Self {
        let mut planner = FftPlanner::new();
        let step = std::f64::consts::TAU / samples as f64;
        let tables = Tables {
            turns: (0..=samples)
                .map(|n| Complex::from_polar(1.0, step * (n % samples) as f64))
                .collect(),
            moments: (0..=samples / 3).map(|k| fourier::moments(step * k as f64)).collect(),
        };
        Self {
            inverse: planner.plan_fft_inverse(samples),
            forward: planner.plan_fft_forward(samples),
            tables: Arc::new(tables),
        }
    }

    /// The smallest grid of the ladder with at least so many samples, or the
    /// largest of all; made once.
    pub fn at_least(samples: usize) -> &'static Self {
        static GRIDS: [OnceLock<Grid>; LADDER] = [const { OnceLock::new() }; LADDER];
        let step = (0..LADDER).find(|step| rung(*step) >= samples).unwrap_or(LADDER - 1);
        GRIDS[step].get_or_init(|| Self::of(rung(step)))
    }

    /// exp(2πj·n/N).
    pub fn turn(&self, n: usize) -> Complex {
        self.tables.turns[n]
    }

    /// ∫₀¹ uⁱ exp(−jθu) du at θ = 2πk/N, i = 0 … 5.
    pub fn moments(&self, k: usize) -> [Complex; 6] {
        let theta = std::f64::consts::TAU * k as f64 / self.samples() as f64;
        self.tables.moments.get(k).copied().unwrap_or_else(|| fourier::moments(theta))
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
    run_share: f64,
}

impl Excitation {
    /// Prepares u(t) = Re Σ Uₖ exp(jkωt); `input` holds U₀, U₁ …
    pub fn new(omega_rad_s: f64, input: Vec<Complex>) -> Self {
        let zero = Complex::new(0.0, 0.0);
        let pure_cosine =
            input.len() > 1 && input.iter().enumerate().all(|(k, u)| k == 1 || *u == zero);
        let grid = (!pure_cosine).then(|| Grid::new(input.len().saturating_sub(1)));
        Self { omega_rad_s, input, grid, run_share: 0.0 }
    }

    /// The same at `share` (0 first, 1 last) of the acquisition.
    #[must_use]
    pub fn at_run_share(self, share: f64) -> Self {
        Self { run_share: share, ..self }
    }

    /// Where in the acquisition it stands: 0 first, 1 last.
    pub fn run_share(&self) -> f64 {
        self.run_share
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
    pub(crate) fn torque_lines(&self, actuator: &Actuator) -> Vec<Complex> {
        self.through(actuator, &self.input)
    }

    /// A(jlω)·Xₗ for any lines of the same fundamental.
    pub(crate) fn through(&self, actuator: &Actuator, lines: &[Complex]) -> Vec<Complex> {
        lines
            .iter()
            .enumerate()
            .map(|(l, x)| x * actuator.response(l as f64 * self.omega_rad_s))
            .collect()
    }

    /// The sampling grid; only general inputs have one.
    pub(crate) fn grid(&self) -> Option<&Grid> {
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
