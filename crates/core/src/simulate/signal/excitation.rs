//! A periodic input, prepared once (grid and FFT plan) for many simulations.

use std::fmt;

use crate::measurement::{Complex, Experiment};
use crate::plant::Actuator;

use super::grid::Grid;

/// A periodic input u(t) = Re Σ Uₖ exp(jkωt), prepared for simulation.
#[derive(Clone)]
pub struct Excitation {
    omega_rad_s: f64,
    input: Vec<Complex>,
    grid: Option<Grid>,
    run_share: f64,
}

impl Excitation {
    /// Prepares u(t) = Re Σ Uₖ exp(jkωt); `input` holds U₀, U₁ … in input units. Lines that the
    /// grid of the simulation cannot hold are left out; they are less than a millionth of the
    /// input.
    pub fn new(omega_rad_s: f64, mut input: Vec<Complex>) -> Self {
        let zero = Complex::new(0.0, 0.0);
        let pure_cosine =
            input.len() > 1 && input.iter().enumerate().all(|(k, u)| k == 1 || *u == zero);
        let grid = (!pure_cosine).then(|| Grid::for_lines(&input));
        if let Some(grid) = &grid {
            input.truncate(grid.lines());
        }
        Self { omega_rad_s, input, grid, run_share: 0.0 }
    }

    /// The same input on a coarser grid of at least `fewest` samples a period, which interpolates it
    /// to this error, relative to its rms without the mean. `None` for a pure cosine, and where the
    /// grid would be hardly coarser.
    pub fn coarser(&self, error: f64, fewest: usize) -> Option<Self> {
        let grid = self.grid.as_ref()?.coarser(&self.input, error, fewest)?;
        let mut input = self.input.clone();
        input.truncate(grid.lines());
        Some(Self { input, grid: Some(grid), ..*self })
    }

    /// The same input at another position in the order of acquisition: 0 first, 1 last.
    #[must_use]
    pub fn at_run_share(self, share: f64) -> Self {
        Self { run_share: share, ..self }
    }

    /// Position in the order of acquisition: 0 first, 1 last.
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

    /// Whether the fundamental is the only line.
    pub fn is_pure_cosine(&self) -> bool {
        self.grid.is_none()
    }

    /// Period, seconds.
    pub fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.omega_rad_s
    }

    /// The lines of the torque behind the actuator, Tₗ = A(jlω)·Uₗ.
    pub(crate) fn torque_lines(&self, actuator: &Actuator) -> Vec<Complex> {
        self.through(actuator, &self.input)
    }

    /// A(jlω)·Xₗ for other lines with the same fundamental.
    pub(crate) fn through(&self, actuator: &Actuator, lines: &[Complex]) -> Vec<Complex> {
        lines
            .iter()
            .enumerate()
            .map(|(l, x)| x * actuator.response(l as f64 * self.omega_rad_s))
            .collect()
    }

    /// The sampling grid; `None` for a pure cosine.
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
