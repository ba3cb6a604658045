//! Rows of single repeats that differ from the other repeats of the same experiment.
//!
//! A repeat less the mean of the others has the variance M/(M − 1) of one repeat. That variance is the
//! median over harmonics of nearly the same size, which a few wrong rows do not move. One wrong
//! repeat moves the mean of the others, so that only the one that is furthest off is judged, then the
//! rest without it. Periods of records are not judged: their noise depends on the frequency.

use crate::answers::{LeftOutRow, MeasurementFault};
use crate::measurement::{Complex, Experiment, Measurement};

use super::fault;

/// Fewest repeats of which one can be told from the others.
const FEWEST_REPEATS: usize = 3;

/// Number of harmonics of nearly the same size whose scatter is taken together.
const NEIGHBOURS: usize = 40;

/// Probability that any row of a sound measurement is left out.
const LEVEL: f64 = 1e-3;

/// Share of rows that belong among those that are left out, once one certainly does not (Y. Benjamini,
/// Y. Hochberg 1995, doi:10.1111/j.2517-6161.1995.tb02031.x).
const FALSE_ROWS: f64 = 0.05;

/// Largest share of rows that are left out. Where more differ, the noise depends on something else
/// than the size of the response.
const LARGEST_SHARE: f64 = 0.1;

/// By which factor the squared distance has to exceed its limit: the noise of a gain and that of a
/// phase differ, so that the two parts of a deviation are not alike.
const UNLIKE_PARTS: f64 = 1.5;

/// One harmonic of one experiment.
struct Datum {
    experiment: usize,
    order: usize,
    size: f64,
    /// Each repeat that is left, with its number.
    values: Vec<(usize, Complex)>,
}

impl Datum {
    /// Unbiased variance of each part of one repeat.
    fn variance(&self) -> f64 {
        let count = self.values.len() as f64;
        let mean = self.values.iter().map(|(_, value)| value).sum::<Complex>() / count;
        let squares: f64 = self.values.iter().map(|(_, z)| (z - mean).norm_sqr()).sum();
        squares / (2.0 * (count - 1.0))
    }

    /// The position of the repeat that is furthest from the mean of the others, the squared distance
    /// in units of the variance of one repeat times M/(M − 1), and that mean.
    fn furthest(&self) -> Option<(usize, f64, Complex)> {
        let count = self.values.len() as f64;
        let sum: Complex = self.values.iter().map(|(_, value)| value).sum();
        let each = self.values.iter().enumerate().map(|(position, (_, value))| {
            let others = (sum - value) / (count - 1.0);
            (position, (value - others).norm_sqr() * (count - 1.0) / count, others)
        });
        each.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The rows that differ from the other repeats; `None` if there are none.
pub(super) fn odd_rows(measurement: &Measurement) -> Option<MeasurementFault> {
    let all = measurement.experiments().iter().enumerate();
    let mut data: Vec<Datum> = all
        .filter(|(_, experiment)| !experiment.from_record)
        .filter(|(_, experiment)| experiment.repeats.len() >= FEWEST_REPEATS)
        .flat_map(|(index, experiment)| data_of(index, experiment))
        .collect();
    data.sort_by(|a, b| a.size.total_cmp(&b.size));
    let variances: Vec<Option<f64>> = (0..data.len()).map(|i| usual_variance(&data, i)).collect();
    let rows: usize = data.iter().map(|datum| datum.values.len()).sum();
    // Of a complex normal deviation with variance s² of each part, |d|²/s² exceeds x with the
    // probability exp(−x/2); of a real one with less.
    let limit = |probability: f64| -2.0 * UNLIKE_PARTS * (probability / rows.max(1) as f64).ln();
    let mut odd = Vec::new();
    let mut most = limit(LEVEL);
    loop {
        let before = odd.len();
        for (datum, variance) in data.iter_mut().zip(&variances) {
            if let Some(variance) = variance {
                leave_out(datum, *variance, most, &mut odd);
            }
        }
        if odd.len() == before {
            break;
        }
        most = limit(FALSE_ROWS * (1.0 + odd.len() as f64));
    }
    odd.sort_by_key(|row| (row.experiment, row.harmonic, row.repeat));
    let few = odd.len() as f64 <= LARGEST_SHARE * rows as f64;
    (few && !odd.is_empty()).then(|| fault::bad_rows(odd.into_iter()))
}

/// Takes the repeats out of a datum whose squared distance from the mean of the others, in units of the
/// usual variance, exceeds a limit.
fn leave_out(datum: &mut Datum, variance: f64, limit: f64, odd: &mut Vec<LeftOutRow>) {
    while datum.values.len() >= FEWEST_REPEATS {
        let furthest = datum.furthest().filter(|(_, square, _)| *square > limit * variance);
        let Some((position, square, others)) = furthest else { break };
        let (repeat, value) = datum.values.remove(position);
        let size = others.norm().max(f64::MIN_POSITIVE);
        odd.push(LeftOutRow {
            experiment: datum.experiment,
            harmonic: datum.order,
            repeat: Some(repeat),
            line: None,
            off: ((value - others).norm() / size).min(f64::MAX),
            sigmas: (square / variance).sqrt(),
        });
    }
}

/// The variance of each part of one repeat that is usual at the size of the harmonic at `position`:
/// the median of those of nearly the same size or, if that is more, what the median of their ratios to
/// the square of the size says. Medians are turned into means (Wilson and Hilferty 1931,
/// doi:10.1073/pnas.17.12.684). `None` if nothing scatters.
fn usual_variance(data: &[Datum], position: usize) -> Option<f64> {
    let begin = position.saturating_sub(NEIGHBOURS / 2).min(data.len().saturating_sub(NEIGHBOURS));
    let near = || data[begin..].iter().take(NEIGHBOURS).filter(|datum| datum.order > 0);
    let variance = |datum: &Datum| {
        let dof = 2.0 * (datum.values.len() as f64 - 1.0);
        datum.variance() / (1.0 - 2.0 / (9.0 * dof)).powi(3)
    };
    let of_one_size = median(near().map(variance));
    let relative = median(near().map(|datum| variance(datum) / datum.size.powi(2)));
    let usual = of_one_size?.max(relative? * data[position].size.powi(2));
    (usual > 0.0).then_some(usual)
}

/// The median of the finite values.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn data_of(index: usize, experiment: &Experiment) -> Vec<Datum> {
    let each = experiment.response.iter().enumerate();
    each.map(|(i, harmonic)| {
        let repeats = experiment.repeats.iter().enumerate();
        Datum {
            experiment: index,
            order: harmonic.order,
            size: harmonic.value.norm(),
            values: repeats.map(|(p, repeat)| (p, harmonic.value + repeat.response[i])).collect(),
        }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{exact, noisy};
    use crate::machines::draw::NoiseStatement;
    use crate::measurement::Metadata;

    // The squares of the two limits differ by −3·ln(0.001) + 3·ln(0.1), 14 variances.
    #[test]
    fn a_repeat_that_may_be_chance_is_left_out_beside_one_that_is_none() {
        let sound = noisy(&exact(), NoiseStatement::Repeats(6), 20).experiments().to_vec();
        let repeats = sound.iter().flat_map(|experiment| &experiment.repeats);
        let parts: Vec<f64> =
            repeats.flat_map(|repeat| repeat.response[1..].iter().map(Complex::norm_sqr)).collect();
        let std = (parts.iter().sum::<f64>() / (2.0 * parts.len() as f64) * 6.0 / 5.0).sqrt();
        let left_out = |sigmas: &[(usize, f64)]| {
            let mut experiments = sound.clone();
            for (index, sigmas) in sigmas {
                let repeats = &mut experiments[*index].repeats;
                let rest: Complex = repeats[1..].iter().map(|repeat| repeat.response[3]).sum();
                // Exactly so far from the mean of the others, whose deviation counts, too.
                let off =
                    rest / 5.0 - repeats[0].response[3] + sigmas * std * (6.0_f64 / 5.0).sqrt();
                experiments[*index].response[3].value += off / 6.0;
                for (repeat, deviation) in experiments[*index].repeats.iter_mut().enumerate() {
                    deviation.response[3] += if repeat == 0 { 5.0 * off / 6.0 } else { -off / 6.0 };
                }
            }
            let (metadata, hash) = (Metadata::default(), String::new());
            let whole = Measurement::new(metadata, experiments, Vec::new(), hash).unwrap();
            let rows = odd_rows(&whole).map_or(Vec::new(), |fault| fault.left_out);
            rows.iter().map(|row| row.experiment).collect::<Vec<_>>()
        };
        assert_eq!(left_out(&[(7, 40.0)]), [7]);
        let is_between = |sigmas: &f64| {
            left_out(&[(4, *sigmas)]).is_empty() && left_out(&[(4, *sigmas), (7, 40.0)]) == [4, 7]
        };
        let between: Vec<f64> = (40..120).map(|n| 0.1 * f64::from(n)).filter(is_between).collect();
        assert!(between.len() >= 5, "{between:?}");
    }
}
