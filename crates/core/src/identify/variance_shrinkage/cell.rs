//! The estimated variance of one datum, and the mean of several.

/// The estimated variance of one datum.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Cell {
    /// Experiment it belongs to.
    pub experiment: usize,
    /// Harmonic.
    pub order: usize,
    /// Magnitude of the experiment.
    pub magnitude: f64,
    /// Size |Y| of the datum, in units of the problem.
    pub size: f64,
    /// Whether it comes from the periods of a record.
    pub from_record: bool,
    /// The estimate, in squared units of the problem.
    pub variance: f64,
    /// What noise of the input makes of it, if that is known: the rest follows from the data nearby.
    pub by_input: f64,
    /// Its degrees of freedom; 0 if nothing was repeated.
    pub dof: f64,
}

impl Cell {
    /// Number of repeats that it was estimated from.
    pub fn repeats(&self) -> f64 {
        1.0 + self.dof / if self.order == 0 { 1.0 } else { 2.0 }
    }
}

/// Mean of the variances, weighted by their degrees of freedom.
pub(super) fn pooled(cells: &[Cell]) -> Option<f64> {
    let dof: f64 = cells.iter().map(|cell| cell.dof).sum();
    let sum: f64 = cells.iter().map(|cell| cell.dof * cell.variance).sum();
    (dof > 0.0).then(|| sum / dof)
}
