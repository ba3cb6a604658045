//! The torque of a general input, and the linear response to it, on a uniform grid over one period.
//! Node n is the boundary between cells n − 1 and n.

use crate::measurement::Complex;
use crate::plant::Plant;

use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::samples::{Samples, quintic_at};

/// The torque τ and the steady response w to it, at the nodes.
pub(crate) struct SampledTorque {
    a: f64,
    /// τ and its derivatives.
    pub torque: Samples,
    /// w: steady response of 1/(s + a) to the torque.
    steady: Vec<f64>,
    /// exp(−ah), where h is the length of a cell.
    pub kept: f64,
}

impl SampledTorque {
    pub fn new(plant: &Plant, lines: &[Complex], excitation: &Excitation, grid: &Grid) -> Self {
        let omega = excitation.omega_rad_s();
        let a = plant.viscous_rate_rad_s;
        let through: Vec<Complex> = lines
            .iter()
            .enumerate()
            .map(|(l, torque)| torque / Complex::new(a, l as f64 * omega))
            .collect();
        let (torque, steady) = Samples::of(grid, omega, lines, &through);
        let kept = (-a * torque.step_s).exp();
        Self { a, torque, steady, kept }
    }

    /// Number of cells in the period.
    pub fn cells(&self) -> usize {
        self.torque.cells()
    }

    /// Time of node n, seconds.
    pub fn time(&self, n: usize) -> f64 {
        n as f64 * self.torque.step_s
    }

    /// τ and w at node n.
    pub fn node(&self, n: usize) -> (f64, f64) {
        (self.torque.value[n], self.steady[n])
    }

    /// τ' at the end of a cell.
    pub fn rate_at_end(&self, cell: usize) -> f64 {
        self.torque.first[cell + 1]
    }

    /// τ and τ' at a time within a cell.
    pub fn torque(&self, cell: usize, time_s: f64) -> (f64, f64) {
        (self.torque.at(cell, time_s), self.torque.slope_at(cell, time_s))
    }

    /// τ and w at a time within a cell. w is the quintic through its value and two derivatives at
    /// both nodes; w' = −a·w + τ gives the derivatives exactly.
    pub fn both(&self, cell: usize, time_s: f64) -> (f64, f64) {
        let h = self.torque.step_s;
        let end = |n: usize| {
            let first = self.torque.value[n] - self.a * self.steady[n];
            let second = self.torque.first[n] - self.a * first;
            [self.steady[n], h * first, h * h * second]
        };
        let steady = quintic_at(end(cell), end(cell + 1), time_s / h - cell as f64);
        (self.torque.at(cell, time_s), steady)
    }
}
