//! Where each residual lies: magnitude, frequency, harmonic, order of acquisition. Magnitudes and
//! frequencies are put into a limited number of classes.

use crate::answers::{ComparedExperiment, ComparedHarmonic, Comparison};
use crate::identify::{Component, ModelFit};
use crate::measurement::{Complex, EXCITED_SHARE};

/// Largest number of magnitude classes.
const MOST_MAGNITUDES: usize = 8;

/// Largest number of frequency bands.
const MOST_BANDS: usize = 24;

/// This harmonic and all higher ones form one class.
pub(crate) const LAST_HARMONIC: usize = 11;

/// A range of one axis, ends included.
pub(crate) type Span = [f64; 2];

/// One residual: complex, or real for harmonic 0.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    /// Rows of its real and imaginary part among the residuals.
    pub rows: (usize, Option<usize>),
    /// Class of magnitude.
    pub magnitude: usize,
    /// Band of frequency.
    pub band: usize,
    /// Harmonic, at most [`LAST_HARMONIC`]; always 0 where inputs have many lines.
    pub harmonic: usize,
    /// Frequency of the fundamental, or of the line where inputs have many, in Hz.
    pub frequency_hz: f64,
    /// Half the peak-to-peak value of the input.
    pub input_magnitude: f64,
    /// Index of the experiment.
    pub experiment: usize,
    /// Harmonic as measured.
    pub order: usize,
    /// Whether the input excites this line.
    pub excited: bool,
    /// Position in the order of acquisition.
    pub run: Option<f64>,
    /// Measured value, response units.
    pub measured: Complex,
    /// Simulated value.
    pub simulated: Complex,
    /// Standard deviation of each part.
    pub std: f64,
}

impl Cell {
    /// Rows of its parts.
    pub fn each_row(&self) -> impl Iterator<Item = usize> + use<> {
        [Some(self.rows.0), self.rows.1].into_iter().flatten()
    }
}

/// The cells of a measurement and the classes they fall into.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    /// Every residual except the constraints.
    pub cells: Vec<Cell>,
    /// Smallest and largest magnitude of each class, ascending.
    pub magnitudes: Vec<Span>,
    /// Lowest and highest frequency of each band, Hz, ascending.
    pub bands: Vec<Span>,
    /// Harmonics that occur; empty where inputs have many lines.
    pub harmonics: Vec<usize>,
    /// Whether inputs have many lines, so that residuals are laid out by the frequency of the line.
    pub many_lines: bool,
    /// Units of input and response.
    pub units: (String, String),
}

impl Layout {
    /// The layout of a fitted model.
    pub fn of(fit: &ModelFit) -> Self {
        Self::new(&fit.comparison, &fit.components)
    }

    /// The layout of a comparison; `components` says what each row of the residuals is.
    pub fn new(comparison: &Comparison, components: &[Component]) -> Self {
        let many_lines = has_many_lines(comparison);
        let mut rows = (0..components.len()).filter(|row| !components[*row].constraint);
        let mut cells = Vec::new();
        for experiment in &comparison.experiments {
            let excited = excited(experiment);
            for (harmonic, excited) in experiment.harmonics.iter().zip(excited) {
                let Some(re) = rows.next() else { break };
                let im = if harmonic.order > 0 { rows.next() } else { None };
                let lines = if many_lines { harmonic.order as f64 } else { 1.0 };
                cells.push(Cell {
                    rows: (re, im),
                    magnitude: 0,
                    band: 0,
                    harmonic: if many_lines { 0 } else { harmonic.order.min(LAST_HARMONIC) },
                    frequency_hz: lines * experiment.omega_rad_s / std::f64::consts::TAU,
                    input_magnitude: experiment.magnitude,
                    experiment: experiment.experiment,
                    order: harmonic.order,
                    excited,
                    run: experiment.run,
                    measured: Complex::new(harmonic.measured[0], harmonic.measured[1]),
                    simulated: Complex::new(harmonic.simulated[0], harmonic.simulated[1]),
                    std: harmonic.std,
                });
            }
        }
        let magnitudes = classes(cells.iter().map(|c| c.input_magnitude), MOST_MAGNITUDES);
        let bands = classes(cells.iter().map(|c| c.frequency_hz), MOST_BANDS);
        let class = |spans: &[Span], value: f64| {
            spans.iter().rposition(|[low, _]| *low <= value).unwrap_or(0)
        };
        for cell in &mut cells {
            cell.magnitude = class(&magnitudes, cell.input_magnitude);
            cell.band = class(&bands, cell.frequency_hz);
        }
        let mut harmonics: Vec<usize> = match many_lines {
            true => Vec::new(),
            false => cells.iter().map(|cell| cell.harmonic).collect(),
        };
        harmonics.sort_unstable();
        harmonics.dedup();
        let units = (comparison.input_unit.clone(), comparison.response_unit.clone());
        Self { cells, magnitudes, bands, harmonics, many_lines, units }
    }
}

fn has_many_lines(comparison: &Comparison) -> bool {
    comparison.experiments.iter().any(|e| excited(e).into_iter().filter(|yes| *yes).count() > 1)
}

/// Of every harmonic, whether the input excites it.
fn excited(experiment: &ComparedExperiment) -> Vec<bool> {
    let size = |h: &ComparedHarmonic| match h.order {
        0 => 0.0,
        _ => h.input[0].hypot(h.input[1]),
    };
    let largest = experiment.harmonics.iter().map(size).fold(0.0, f64::max);
    experiment.harmonics.iter().map(|h| size(h) > EXCITED_SHARE * largest).collect()
}

/// At most `most` classes of values, about equally full; equal values share a class.
pub(crate) fn classes(values: impl Iterator<Item = f64>, most: usize) -> Vec<Span> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    // Values that agree to 1e-6 differ only by rounding.
    let apart = |a: f64, b: f64| b - a > 1e-6 * b.abs();
    let mut spans: Vec<(Span, usize)> = Vec::new();
    for value in sorted {
        match spans.last_mut() {
            Some((span, count)) if !apart(span[0], value) => {
                span[1] = value;
                *count += 1;
            }
            _ => spans.push(([value, value], 1)),
        }
    }
    if spans.len() <= most {
        return spans.into_iter().map(|(span, _)| span).collect();
    }
    let all: usize = spans.iter().map(|(_, count)| count).sum();
    let mut joined: Vec<Span> = Vec::new();
    let (mut before, mut class) = (0, usize::MAX);
    for ([low, high], count) in spans {
        let here = before * most / all;
        if here == class {
            joined.last_mut().expect("it has begun")[1] = high;
        } else {
            joined.push([low, high]);
            class = here;
        }
        before += count;
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_are_classes_of_their_own_and_many_are_joined_evenly() {
        let few = classes([2.0, 1.0, 2.0, 1.0 + 1e-9].into_iter(), 8);
        assert_eq!(few, [[1.0, 1.0 + 1e-9], [2.0, 2.0]]);
        let many = classes((0..100).map(f64::from), 4);
        assert_eq!(many, [[0.0, 24.0], [25.0, 49.0], [50.0, 74.0], [75.0, 99.0]]);
    }
}
