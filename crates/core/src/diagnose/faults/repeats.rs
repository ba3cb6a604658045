//! Rows of single repeats that differ from the other repeats of the same experiment.
//!
//! A repeat less the mean of the others has the variance M/(M − 1) of one repeat. That variance follows
//! from the medians over harmonics of nearly the same size, and over those of nearly the same frequency,
//! which a few wrong rows do not move: the larger one counts, since noise may depend on either. One wrong
//! repeat moves the mean of the others, so that only the one that is furthest off is judged, then the
//! rest without it. Periods of records are not judged.

use crate::answers::{LeftOutRow, MeasurementFault};
use crate::measurement::{Complex, Experiment, Measurement};

use super::fault;
use super::usual_scatter::{self, Scatter, Usual};

/// Fewest repeats of which one can be told from the others.
const FEWEST_REPEATS: usize = 3;

/// The scatter is a power of the size, from 0, noise of one size, to 2, of a share; and of the frequency:
/// −2 for a position that is computed from velocities, −4 from accelerations, and the reverse.
const POWERS_OF_SIZE: [f64; 2] = [0.0, 2.0];
const POWERS_OF_FREQUENCY: [f64; 2] = [-4.0, 4.0];

/// Probability that any row of a sound measurement is left out.
const LEVEL: f64 = 1e-3;

/// Share of rows that belong among those that are left out, once one certainly does not (Y. Benjamini,
/// Y. Hochberg 1995, doi:10.1111/j.2517-6161.1995.tb02031.x).
const FALSE_ROWS: f64 = 0.05;

/// Largest share of rows that are left out. Where more differ, the noise depends on something else
/// than the size of the response and the frequency.
const LARGEST_SHARE: f64 = 0.1;

/// By which factor the squared distance has to exceed its limit, because the usual variance is known to
/// about a tenth only.
const BEYOND: f64 = 1.1;

/// One harmonic of one experiment.
struct Datum {
    experiment: usize,
    order: usize,
    size: f64,
    /// Angular frequency, rad/s; of the mean that of the fundamental.
    frequency: f64,
    /// Each repeat that is left, with its number.
    values: Vec<(usize, Complex)>,
}

impl Datum {
    fn scatter(&self) -> Scatter {
        let dof = 2.0 * (self.values.len() as f64 - 1.0);
        Scatter { variances: self.variances(), dof, is_complex: self.order > 0 }
    }

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
    let scatter: Vec<Scatter> = data.iter().map(Datum::scatter).collect();
    let of_each = |of: fn(&Datum) -> f64, powers| {
        usual_scatter::of_each(&scatter, &data.iter().map(of).collect::<Vec<_>>(), powers)
    };
    let by_size = of_each(|datum| datum.size, POWERS_OF_SIZE);
    let by_frequency = of_each(|datum| datum.frequency, POWERS_OF_FREQUENCY);
    let both = by_size.into_iter().zip(by_frequency);
    let usual: Vec<Option<Usual>> = both.map(|(one, other)| Some(one?.or_larger(other?))).collect();
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

fn data_of(index: usize, experiment: &Experiment) -> Vec<Datum> {
    let each = experiment.response.iter().enumerate();
    each.map(|(i, harmonic)| {
        let repeats = experiment.repeats.iter().enumerate();
        Datum {
            experiment: index,
            order: harmonic.order,
            size: harmonic.value.norm(),
            frequency: harmonic.order.max(1) as f64 * experiment.omega_rad_s,
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

    // As of a position that is computed from velocities.
    #[test]
    fn noise_that_depends_on_the_frequency_leaves_no_row_out_and_hides_none() {
        let mut experiments =
            noisy(&exact(), NoiseStatement::Repeats(6), 20).experiments().to_vec();
        for Experiment { omega_rad_s, response, repeats, .. } in &mut experiments {
            for deviations in repeats {
                for (deviation, harmonic) in deviations.response.iter_mut().zip(&*response) {
                    *deviation /= harmonic.order.max(1) as f64 * *omega_rad_s;
                }
            }
        }
        let odd = |experiments: &[Experiment]| {
            let (metadata, hash) = (Metadata::default(), String::new());
            odd_rows(&Measurement::new(metadata, experiments.to_vec(), Vec::new(), hash).unwrap())
        };
        assert_eq!(odd(&experiments), None);
        for (repeat, deviations) in experiments[7].repeats.iter_mut().enumerate() {
            deviations.response[1] += if repeat == 2 { 1.0 } else { -0.2 };
        }
        let rows = odd(&experiments).unwrap().left_out;
        let places: Vec<_> =
            rows.iter().map(|row| (row.experiment, row.harmonic, row.repeat)).collect();
        assert_eq!(places, [(7, 1, Some(2))]);
    }

    // The squares of the two limits differ by −2.2·ln(0.001) + 2.2·ln(0.1), 10 variances.
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
