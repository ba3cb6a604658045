//! Rows that differ from their neighbours in frequency by far more than these from each other.
//!
//! Where a measurement has wrong rows and the machine an effect, no model of the effect can be fitted
//! to all rows, and a model without it leaves more than the wrong rows alone. But what a model lacks
//! varies smoothly with the frequency, and a wrong row does not. So where nothing explains a
//! measurement, rows are left out that stand out from the medians of their neighbours. Whether they
//! belong is decided at the end: [`belonging`] are those that the final model predicts.

use std::collections::BTreeMap;

use crate::answers::{
    Comparison, Diagnosis, FaultKind, Identification, LeftOutRow, MeasurementFault,
};
use crate::identify;
use crate::measurement::{Complex, Measurement};

use super::{fault, mending};

/// Neighbours on each side with which a row is compared.
const NEIGHBOURS: usize = 2;

/// Fewest rows of one magnitude and harmonic of which one can stand out.
const FEWEST: usize = 2 * NEIGHBOURS + 1;

/// By how many deviations a row has to differ from the median of its neighbours: of a thousand rows of
/// noise, whose median adds to theirs, one in a thousand tables has such a row.
const STANDS_OUT: f64 = 6.5;

/// By how many times the scatter of the neighbours about their median.
const BEYOND_SCATTER: f64 = 5.0;

/// Largest share of rows that are left out.
const LARGEST_SHARE: f64 = 0.1;

/// A row belongs that is within so many deviations of what is predicted for it: noise is beyond in one
/// of a hundred.
const WITHIN: f64 = 3.03;

/// One row of a comparison.
pub(super) struct Row {
    /// Index of the experiment.
    pub experiment: usize,
    /// Harmonic.
    pub order: usize,
    /// What is left, in deviations.
    pub left: Complex,
    /// Size of what is expected, in deviations.
    expected: f64,
}

/// Rows of a table that stand out beside the best model of an answer; `None` if there are none.
pub(super) fn rows(answer: &Diagnosis, measurement: &Measurement) -> Option<MeasurementFault> {
    let is_table = measurement.experiments().iter().all(|e| e.pure_cosine().is_some());
    let comparison = compared(answer, measurement).filter(|_| is_table)?;
    let mut series: BTreeMap<(u64, usize), Vec<(f64, Row)>> = BTreeMap::new();
    for (at, row) in each(&comparison) {
        let (magnitude, omega_rad_s) = at;
        series.entry((magnitude.to_bits(), row.order)).or_default().push((omega_rad_s, row));
    }
    let all: usize = series.values().map(Vec::len).sum();
    let mut odd: Vec<LeftOutRow> = Vec::new();
    for rows in series.values_mut() {
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        while rows.len() >= FEWEST {
            let values: Vec<Complex> = rows.iter().map(|(_, row)| row.left).collect();
            let Some(place) = furthest(&values) else { break };
            let (_, row) = rows.remove(place);
            odd.push(LeftOutRow {
                experiment: row.experiment,
                harmonic: row.order,
                repeat: None,
                line: None,
                off: (row.left.norm() / row.expected.max(f64::MIN_POSITIVE)).min(f64::MAX),
                sigmas: row.left.norm(),
            });
        }
    }
    let few = odd.len() as f64 <= LARGEST_SHARE * all as f64;
    (few && !odd.is_empty()).then(|| fault::bad_rows(odd.into_iter()))
}

/// Those of them that stand out from everything else that the model leaves, too: by five times its root
/// mean square. What a model lacks need not be smooth over the frequency, where it drifts and the
/// frequencies were measured in another order.
pub(super) fn outliers(answer: &Diagnosis, measurement: &Measurement) -> Option<MeasurementFault> {
    let mut fault = rows(answer, measurement)?;
    let comparison = compared(answer, measurement)?;
    let is_out = |row: &Row| {
        fault.left_out.iter().any(|o| (o.experiment, o.harmonic) == (row.experiment, row.order))
    };
    let rest = each(&comparison).filter(|(_, row)| !is_out(row));
    let squares: Vec<f64> = rest.map(|(_, row)| row.left.norm_sqr()).collect();
    let rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
    fault.left_out.retain(|row| row.sigmas > BEYOND_SCATTER * rms);
    (!fault.left_out.is_empty()).then_some(fault)
}

/// These faults without the rows that the model of an answer predicts; `None` if all are needed.
pub(super) fn belonging(
    answer: &Diagnosis,
    measurement: &Measurement,
    faults: &[MeasurementFault],
) -> Option<Vec<MeasurementFault>> {
    let others: Vec<MeasurementFault> =
        faults.iter().filter(|fault| fault.fault != FaultKind::BadRows).cloned().collect();
    let comparison = compared(answer, &mending::mended(measurement, &others).ok()?.measurement)?;
    let predicted: Vec<(usize, usize)> = each(&comparison)
        .filter(|(_, row)| row.left.norm() < WITHIN)
        .map(|(_, row)| (row.experiment, row.order))
        .collect();
    let belongs = |row: &LeftOutRow| {
        row.repeat.is_none() && predicted.contains(&(row.experiment, row.harmonic))
    };
    let mut fewer = faults.to_vec();
    fewer.iter_mut().for_each(|fault| fault.left_out.retain(|row| !belongs(row)));
    fewer.retain(|fault| fault.fault != FaultKind::BadRows || !fault.left_out.is_empty());
    (fewer != faults).then_some(fewer)
}

/// The whole measurement beside the best model of an answer.
pub(super) fn compared(answer: &Diagnosis, measurement: &Measurement) -> Option<Comparison> {
    let best: &Identification = answer.extended.as_ref().unwrap_or(&answer.base);
    identify::compare(measurement, best).ok()
}

/// The rows of a comparison, with their magnitude and frequency.
pub(super) fn each(comparison: &Comparison) -> impl Iterator<Item = ((f64, f64), Row)> {
    comparison.experiments.iter().flat_map(|experiment| {
        experiment.harmonics.iter().map(|harmonic| {
            let complex = |[re, im]: [f64; 2]| Complex::new(re, im) / harmonic.std;
            let (measured, simulated) = (complex(harmonic.measured), complex(harmonic.simulated));
            let row = Row {
                experiment: experiment.experiment,
                order: harmonic.order,
                left: measured - simulated,
                expected: simulated.norm(),
            };
            ((experiment.magnitude, experiment.omega_rad_s), row)
        })
    })
}

/// The place of the value that stands out most from its neighbours; `None` if none does.
fn furthest(values: &[Complex]) -> Option<usize> {
    let out = (0..values.len()).filter_map(|place| {
        let begin = place.saturating_sub(NEIGHBOURS).min(values.len().saturating_sub(FEWEST));
        let near = begin..(begin + FEWEST).min(values.len());
        let near: Vec<Complex> =
            near.filter(|other| *other != place).map(|other| values[other]).collect();
        let middle = Complex::new(
            median(near.iter().map(|value| value.re)),
            median(near.iter().map(|value| value.im)),
        );
        let scatter = median(near.iter().map(|value| (value - middle).norm()));
        let distance = (values[place] - middle).norm();
        let stands_out = distance > STANDS_OUT && distance > BEYOND_SCATTER * scatter;
        stands_out.then_some((distance, place))
    });
    out.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// The median; of an even number of values the mean of the two in the middle.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        _ if values.is_empty() => 0.0,
        0 => 0.5 * (values[middle - 1] + values[middle]),
        _ => values[middle],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth departure of up to 40 deviations.
    fn smooth(place: usize) -> Complex {
        Complex::from_polar(40.0 * (-(place as f64 - 8.0).powi(2) / 30.0).exp(), 0.3 * place as f64)
    }

    #[test]
    fn a_row_stands_out_from_its_neighbours_and_a_smooth_departure_does_not() {
        let mut values: Vec<Complex> = (0..16).map(smooth).collect();
        assert_eq!(furthest(&values), None);
        values[3] += Complex::new(60.0, 0.0);
        assert_eq!(furthest(&values), Some(3));
        values[15] += Complex::new(0.0, -90.0);
        assert_eq!(furthest(&values), Some(15), "the last has neighbours on one side");
    }

    #[test]
    fn of_two_wrong_neighbours_each_stands_out() {
        let mut values = vec![Complex::ZERO; 12];
        (values[5], values[6]) = (Complex::new(30.0, 0.0), Complex::new(0.0, 50.0));
        let first = furthest(&values).unwrap();
        assert_eq!(first, 6);
        values.remove(first);
        assert_eq!(furthest(&values), Some(5));
    }
}
