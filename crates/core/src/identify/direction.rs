//! Directions in the data along which residuals count less, or not at all.

/// A direction in the data of one experiment, as a unit vector in units of the noise. Those of an
/// experiment are orthogonal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direction {
    /// The experiment.
    pub experiment: usize,
    /// The first row of the experiment.
    pub first: usize,
    /// One component for each of its rows, or for the first of them; the others are 0.
    pub rows: Vec<f64>,
    /// What is kept of a residual along it, from 0 to 1.
    pub kept: f64,
}

/// Scales a vector over all rows along each of these directions.
pub(super) fn reduce(directions: &[Direction], vector: &mut [f64]) {
    for Direction { first, rows, kept, .. } in directions {
        take_share_from(&mut vector[*first..first + rows.len()], rows, 1.0 - kept);
    }
}

/// Takes from these rows what lies along a direction.
pub(super) fn take_from(rows: &mut [f64], direction: &[f64]) {
    take_share_from(rows, direction, 1.0);
}

fn take_share_from(rows: &mut [f64], direction: &[f64], share: f64) {
    let along: f64 = rows.iter().zip(direction).map(|(value, own)| value * own).sum();
    let taken = share * along;
    rows.iter_mut().zip(direction).for_each(|(value, own)| *value -= taken * own);
}
