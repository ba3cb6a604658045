//! Rows of single repeats that differ from the other repeats of the same experiment.
//!
//! The distance of each repeat from the median of all repeats is compared with the median distance
//! at harmonics of nearly the same size, which a few wrong rows do not move.

use crate::answers::{LeftOutRow, MeasurementFault};
use crate::measurement::{Complex, Experiment, Measurement};

use super::fault;

/// Fewest repeats of which one can be told from the others.
const FEWEST_REPEATS: usize = 3;

/// Number of harmonics of nearly the same size whose scatter is taken together.
const NEIGHBOURS: usize = 40;

/// Probability that any row of a sound measurement is left out.
const LEVEL: f64 = 1e-3;

/// One harmonic of one experiment.
struct Datum {
    experiment: usize,
    order: usize,
    size: f64,
    /// Squared distance of each repeat from their median, and the value there.
    distances: Vec<f64>,
    median: Complex,
}

/// The rows that differ from the other repeats; `None` if there are none.
pub(super) fn odd_rows(measurement: &Measurement) -> Option<MeasurementFault> {
    let all = measurement.experiments().iter().enumerate();
    let mut data: Vec<Datum> = all
        .filter(|(_, experiment)| experiment.repeats.len() >= FEWEST_REPEATS)
        .flat_map(|(index, experiment)| data_of(index, experiment))
        .collect();
    data.sort_by(|a, b| a.size.total_cmp(&b.size));
    let rows: usize = data.iter().map(|datum| datum.distances.len()).sum();
    // Of a complex normal deviation with variance s² of each part, |d|²/s² exceeds x with the
    // probability exp(−x/2), and its median is 2 ln 2. The median of the repeats scatters itself.
    let limit = -2.0 * (LEVEL / rows.max(1) as f64).ln();
    let mut odd = Vec::new();
    for (position, datum) in data.iter().enumerate() {
        let begin =
            position.saturating_sub(NEIGHBOURS / 2).min(data.len().saturating_sub(NEIGHBOURS));
        let near = &data[begin..(begin + NEIGHBOURS).min(data.len())];
        // A mean has one part instead of two, and smaller distances.
        let alike = near.iter().filter(|datum| datum.order > 0);
        let mut distances: Vec<f64> = alike.flat_map(|d| d.distances.iter().copied()).collect();
        if distances.is_empty() {
            continue;
        }
        let middle = distances.len() / 2;
        let (_, typical, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
        let repeats = datum.distances.len() as f64;
        let variance = *typical / (2.0 * std::f64::consts::LN_2) * (repeats / (repeats - 1.0));
        if variance <= 0.0 {
            continue;
        }
        for (repeat, distance) in datum.distances.iter().enumerate() {
            if *distance > limit * variance {
                odd.push(LeftOutRow {
                    experiment: datum.experiment,
                    harmonic: datum.order,
                    repeat: Some(repeat),
                    line: None,
                    off: (distance.sqrt() / datum.median.norm().max(f64::MIN_POSITIVE))
                        .min(f64::MAX),
                    sigmas: (distance / variance).sqrt(),
                });
            }
        }
    }
    odd.sort_by_key(|row| (row.experiment, row.harmonic, row.repeat));
    (!odd.is_empty()).then(|| fault::bad_rows(odd.into_iter()))
}

fn data_of(index: usize, experiment: &Experiment) -> Vec<Datum> {
    let each = experiment.response.iter().enumerate();
    each.map(|(i, harmonic)| {
        let values = || experiment.repeats.iter().map(|repeat| repeat.response[i]);
        let shift = Complex::new(median(values().map(|z| z.re)), median(values().map(|z| z.im)));
        Datum {
            experiment: index,
            order: harmonic.order,
            size: harmonic.value.norm(),
            distances: values().map(|z| (z - shift).norm_sqr()).collect(),
            median: harmonic.value + shift,
        }
    })
    .collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}
