//! Size of the residuals by magnitude, by frequency, by harmonic and by order of acquisition.

use crate::answers::ResidualGroup;

use super::layout::{Cell, LAST_HARMONIC, Span, classes};
use super::residual::Residuals;

/// Largest number of groups of consecutive runs.
const MOST_STRETCHES: usize = 8;

/// Largest number of groups of harmonics where inputs have many lines.
const MOST_BANDS: usize = 12;

/// Residuals by magnitude.
pub(crate) fn by_magnitude(residuals: &Residuals) -> Vec<ResidualGroup> {
    let spans = residuals.layout.magnitudes.iter().enumerate();
    spans.filter_map(|(i, span)| group(residuals, *span, |cell| cell.magnitude == i)).collect()
}

/// Residuals by frequency, Hz.
pub(crate) fn by_frequency(residuals: &Residuals) -> Vec<ResidualGroup> {
    let spans = residuals.layout.bands.iter().enumerate();
    spans.filter_map(|(i, span)| group(residuals, *span, |cell| cell.band == i)).collect()
}

/// Residuals by harmonic, or by groups of them where inputs have many lines.
pub(crate) fn by_harmonic(residuals: &Residuals) -> Vec<ResidualGroup> {
    let orders = residuals.layout.cells.iter().map(|cell| cell.order as f64);
    let most = if residuals.layout.many_lines { MOST_BANDS } else { LAST_HARMONIC + 1 };
    by(residuals, classes(orders, most), |cell| Some(cell.order as f64))
}

/// Residuals by order of acquisition; empty where it is not known.
pub(crate) fn by_run(residuals: &Residuals) -> Vec<ResidualGroup> {
    let runs = residuals.layout.cells.iter().filter_map(|cell| cell.run);
    by(residuals, classes(runs, MOST_STRETCHES), |cell| cell.run)
}

fn by(
    residuals: &Residuals,
    spans: Vec<Span>,
    level: impl Fn(&Cell) -> Option<f64>,
) -> Vec<ResidualGroup> {
    let inside = |cell: &Cell, [low, high]: Span| {
        level(cell).is_some_and(|value| (low..=high).contains(&value))
    };
    spans.into_iter().filter_map(|s| group(residuals, s, |cell| inside(cell, s))).collect()
}

fn group(
    residuals: &Residuals,
    [from, to]: Span,
    holds: impl Fn(&Cell) -> bool,
) -> Option<ResidualGroup> {
    let cells: Vec<&Cell> = residuals.layout.cells.iter().filter(|cell| holds(cell)).collect();
    let sizes = Sizes::of(residuals, &cells)?;
    Some(ResidualGroup {
        from,
        to,
        count: cells.len(),
        rms_sigmas: sizes.rms_sigmas,
        rms_response: sizes.rms_left,
        relative: sizes.relative(),
    })
}

/// Sizes of some residuals and of the response there.
pub(crate) struct Sizes {
    /// Root mean square of the standardised real and imaginary parts.
    pub rms_sigmas: f64,
    /// Root mean square of |measured − simulated|, response units.
    pub rms_left: f64,
    /// Root mean square of the measured values, response units.
    pub rms_measured: f64,
    /// Root mean square of the simulated values, response units.
    pub rms_simulated: f64,
}

impl Sizes {
    /// Sizes over these cells; `None` if there are none.
    pub fn of(residuals: &Residuals, cells: &[&Cell]) -> Option<Self> {
        let rows: Vec<usize> = cells.iter().flat_map(|cell| cell.each_row()).collect();
        let squares: f64 = rows.iter().map(|row| residuals.values[*row].powi(2)).sum();
        let rms = |square: &dyn Fn(&Cell) -> f64| {
            (cells.iter().map(|cell| square(cell)).sum::<f64>() / cells.len() as f64).sqrt()
        };
        (!cells.is_empty()).then(|| Self {
            rms_sigmas: (squares / rows.len() as f64).sqrt(),
            rms_left: rms(&|cell| (cell.measured - cell.simulated).norm_sqr()),
            rms_measured: rms(&|cell| cell.measured.norm_sqr()),
            rms_simulated: rms(&|cell| cell.simulated.norm_sqr()),
        })
    }

    /// `rms_left` as a share of `rms_measured`; 1 where less was measured (an axis at rest).
    fn relative(&self) -> f64 {
        let size = self.rms_measured.max(self.rms_left);
        if size > 0.0 { self.rms_left / size } else { 0.0 }
    }
}
