//! Rows of single repeats that differ from the other repeats of the same experiment.
//!
//! A repeat less the mean of the others has the variance M/(M − 1) of one repeat. That variance follows
//! from the medians over harmonics of nearly the same size, which a few wrong rows do not move. One wrong
//! repeat moves the mean of the others, so that only the one that is furthest off is judged, then the
//! rest without it. Periods of records are not judged: their noise depends on the frequency.

use crate::answers::{LeftOutRow, MeasurementFault};
use crate::measurement::{Complex, Experiment, Measurement};

use super::fault;

/// Fewest repeats of which one can be told from the others.
const FEWEST_REPEATS: usize = 3;

/// Number of harmonics of nearly the same size whose scatter is taken together.
const NEIGHBOURS: usize = 40;

/// Number of those of which it is judged how the scatter depends on the size.
const FURTHER_NEIGHBOURS: usize = 80;

/// Probability that any row of a sound measurement is left out.
const LEVEL: f64 = 1e-3;

/// Share of rows that belong among those that are left out, once one certainly does not (Y. Benjamini,
/// Y. Hochberg 1995, doi:10.1111/j.2517-6161.1995.tb02031.x).
const FALSE_ROWS: f64 = 0.05;

/// Largest share of rows that are left out. Where more differ, the noise depends on something else
/// than the size of the response.
const LARGEST_SHARE: f64 = 0.1;

/// By which factor the squared distance has to exceed its limit, because the usual variance is known to
/// about a tenth only: the median of forty variances of ten degrees of freedom.
const BEYOND: f64 = 1.1;

/// One harmonic of one experiment.
struct Datum {
    experiment: usize,
    order: usize,
    size: f64,
    /// Each repeat that is left, with its number.
    values: Vec<(usize, Complex)>,
}

impl Datum {
    /// Unbiased variances of the parts of one repeat along the mean and across it.
    fn variances(&self) -> [f64; 2] {
        let count = self.values.len() as f64;
        let mean = self.values.iter().map(|(_, value)| value).sum::<Complex>() / count;
        let along = mean.conj() / mean.norm().max(f64::MIN_POSITIVE);
        let turned = self.values.iter().map(|(_, value)| (value - mean) * along);
        turned.fold([0.0; 2], |[re, im], z| {
            [re + z.re.powi(2) / (count - 1.0), im + z.im.powi(2) / (count - 1.0)]
        })
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
    let usual: Vec<Option<Usual>> = (0..data.len()).map(|i| Usual::at(&data, i)).collect();
    let rows: usize = data.iter().map(|datum| datum.values.len()).sum();
    // Of a complex normal deviation with variance s² of each part, |d|²/s² exceeds x with the
    // probability exp(−x/2); of a real one with less.
    let limit = |probability: f64| -2.0 * BEYOND * (probability / rows.max(1) as f64).ln();
    let mut odd = Vec::new();
    let mut most = limit(LEVEL);
    loop {
        let before = odd.len();
        for (datum, usual) in data.iter_mut().zip(&usual) {
            if let Some(usual) = usual {
                leave_out(datum, usual, most, &mut odd);
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
fn leave_out(datum: &mut Datum, usual: &Usual, limit: f64, odd: &mut Vec<LeftOutRow>) {
    while datum.values.len() >= FEWEST_REPEATS {
        let furthest = datum.furthest().filter(|(_, square, _)| *square > limit * usual.larger);
        let Some((position, square, others)) = furthest else { break };
        let (repeat, value) = datum.values.remove(position);
        let size = others.norm().max(f64::MIN_POSITIVE);
        odd.push(LeftOutRow {
            experiment: datum.experiment,
            harmonic: datum.order,
            repeat: Some(repeat),
            line: None,
            off: ((value - others).norm() / size).min(f64::MAX),
            sigmas: (square / usual.mean).sqrt(),
        });
    }
}

/// What is usual of one repeat.
struct Usual {
    /// Mean of the variances of its two parts.
    mean: f64,
    /// The larger of the two: the noise of a gain and that of a phase differ.
    larger: f64,
}

impl Usual {
    /// At the size of the harmonic at `position`, from those of nearly the same size: their variances as a
    /// power of the size, from 0, noise of one size, to 2, of a share, by the median of the slopes between
    /// all pairs (H. Theil 1950; P. K. Sen 1968, doi:10.1080/01621459.1968.10480934). Medians are
    /// turned into means (Wilson and Hilferty 1931, doi:10.1073/pnas.17.12.684). `None` if nothing
    /// scatters.
    fn at(data: &[Datum], position: usize) -> Option<Self> {
        let scatter = |datum: &Datum| {
            let [along, across] = datum.variances();
            let dof = 2.0 * (datum.values.len() as f64 - 1.0);
            let mean = 0.5 * (along + across) / (1.0 - 2.0 / (9.0 * dof)).powi(3);
            (datum.size.max(f64::MIN_POSITIVE).ln(), mean.ln(), [along, across])
        };
        let nearest = |count: usize| {
            let begin = position.saturating_sub(count / 2).min(data.len().saturating_sub(count));
            let near = data[begin..].iter().take(count).filter(|datum| datum.order > 0);
            near.map(scatter).collect::<Vec<(f64, f64, [f64; 2])>>()
        };
        let further = nearest(FURTHER_NEIGHBOURS);
        let pairs = further
            .iter()
            .enumerate()
            .flat_map(|(i, a)| further[i + 1..].iter().map(move |b| (b.1 - a.1) / (b.0 - a.0)));
        let power = median(pairs).unwrap_or(0.0).clamp(0.0, 2.0);
        let near = nearest(NEIGHBOURS);
        if median(near.iter().map(|(.., [along, across])| along + across))? == 0.0 {
            return None;
        }
        let size = data[position].size.max(f64::MIN_POSITIVE).ln();
        let mean = median(near.iter().map(|(at, ln, _)| ln + power * (size - at)))?.exp();
        let part = |which: usize| median(near.iter().map(|(.., parts)| parts[which]));
        let (along, across) = (part(0)?, part(1)?);
        let larger = 2.0 * mean * along.max(across) / (along + across);
        larger.is_finite().then_some(Self { mean, larger })
    }
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
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::diagnose::tests::{exact, noisy};
    use crate::machines::draw::NoiseStatement;
    use crate::measurement::Metadata;

    // The squares of the two limits differ by −2.2·ln(0.001) + 2.2·ln(0.1), 10 variances.
    // The median of forty variances of ten degrees of freedom is known to 9 %, the power over a factor of
    // ten in size to 0.1, half a factor of three away from the middle: 12 % together, and three times that.
    #[test]
    fn the_usual_scatter_follows_noise_of_one_size_and_of_a_share_alike() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for (power, [along, across]) in [(0, [1.0, 1.0]), (1, [1.0, 1.0]), (1, [1.2, 0.75])] {
            let mut datum = |n: i32| {
                let size = 1.03_f64.powi(n);
                let std = 0.01 * size.powi(power);
                let mut part = |share: f64| -> f64 {
                    let value: f64 = StandardNormal.sample(&mut rng);
                    std * share * value
                };
                let values = (0..6).map(|i| (i, Complex::new(size + part(along), part(across))));
                Datum { experiment: 0, order: 1, size, values: values.collect() }
            };
            let data: Vec<Datum> = (0..120).map(&mut datum).collect();
            for position in [0, 60, 119] {
                let usual = Usual::at(&data, position).unwrap();
                let std = 0.01 * data[position].size.powi(power);
                let mean = 0.5 * (along * along + across * across) * std.powi(2);
                let larger = (along * along) * std.powi(2);
                let near = |a: f64, b: f64| (a / b).ln().abs() < 0.35;
                assert!(near(usual.mean, mean), "{power} {position}: {} {mean}", usual.mean);
                assert!(
                    near(usual.larger, larger),
                    "{power} {position}: {} {larger}",
                    usual.larger
                );
            }
        }
    }

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
