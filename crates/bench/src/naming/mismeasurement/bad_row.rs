//! Rows of a table that do not belong to the rest.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::LeftOutRow;
use servoscope_core::measurement::{Complex, Experiment, Measurement};

use crate::machines::draw::log_uniform;
use crate::machines::noise::NoiseLaw;

/// Smallest and largest error of a bad row, as a share of its value.
const ERROR: [f64; 2] = [0.05, 0.5];
/// A row is detectable if its residual exceeds this many standard deviations.
pub(super) const DETECTABLE_SIGMAS: f64 = 5.0;

/// A row whose value is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BadRow {
    /// Index of the experiment, from 0.
    pub experiment: usize,
    /// Harmonic.
    pub harmonic: usize,
    /// Index of the repeat, from 0; null if the experiment has none.
    pub repeat: Option<usize>,
    /// Factor by which the value is wrong.
    pub factor: f64,
    /// Size of its residual, the distance of the wrong value with its noise from the exact one, in true
    /// standard deviations of re or im of this row.
    pub sigmas: f64,
}

impl BadRow {
    /// Draws a share of the rows, at least one, with errors of either sign and a log-uniform size.
    /// Of an experiment with repeats every repeat has its rows. `exact` is the measurement without noise.
    pub(super) fn draw(
        share: f64,
        [measurement, exact]: [&Measurement; 2],
        law: &NoiseLaw,
        rng: &mut ChaCha8Rng,
    ) -> Vec<Self> {
        let rows = rows([measurement, exact], law);
        let count = (share * rows.len() as f64).round().max(1.0) as usize;
        let with_value: Vec<Row> = rows.into_iter().filter(|row| row.value.norm() > 0.0).collect();
        let mut chosen: Vec<Row> = with_value.sample(rng, count).copied().collect();
        chosen.sort_by_key(|row| (row.experiment, row.harmonic, row.repeat));
        let bad = |row: Row| {
            let [least, most] = ERROR;
            let error = log_uniform(least, most, rng);
            let sign = if rng.random() { 1.0 } else { -1.0 };
            let Row { experiment, harmonic, repeat, value, exact, std } = row;
            let factor = 1.0 + sign * error;
            let sigmas = (value * factor - exact).norm() / std;
            Self { experiment, harmonic, repeat, factor, sigmas }
        };
        chosen.into_iter().map(bad).collect()
    }

    /// Whether the noise does not hide that it is wrong.
    pub fn is_detectable(&self) -> bool {
        self.sigmas > DETECTABLE_SIGMAS
    }

    /// Whether this is the row that was left out.
    pub(in crate::naming) fn is(&self, row: &LeftOutRow) -> bool {
        (self.experiment, self.harmonic, self.repeat) == (row.experiment, row.harmonic, row.repeat)
    }

    /// Makes the row wrong in its experiment. That of a repeat changes the mean over the repeats,
    /// and so the deviations of all of them.
    pub(super) fn spoil(&self, experiment: &mut Experiment) {
        let of_row = |order: usize| order == self.harmonic;
        let Some(place) = experiment.response.iter().position(|row| of_row(row.order)) else {
            return;
        };
        let mean = &mut experiment.response[place].value;
        let Some(repeat) = self.repeat else {
            *mean *= self.factor;
            return;
        };
        let error = (*mean + experiment.repeats[repeat].response[place]) * (self.factor - 1.0);
        let shift: Complex = error / experiment.repeats.len() as f64;
        *mean += shift;
        for one in &mut experiment.repeats {
            one.response[place] -= shift;
        }
        experiment.repeats[repeat].response[place] += error;
    }
}

/// A row: its value as it was measured, that without noise, and the true standard deviation; response
/// units.
#[derive(Clone, Copy)]
struct Row {
    experiment: usize,
    harmonic: usize,
    repeat: Option<usize>,
    value: Complex,
    exact: Complex,
    std: f64,
}

fn rows([measurement, exact]: [&Measurement; 2], law: &NoiseLaw) -> Vec<Row> {
    let mut rows = Vec::new();
    for (experiment, measured) in measurement.experiments().iter().enumerate() {
        for (place, mean) in measured.response.iter().enumerate() {
            let harmonic = mean.order;
            let exact = exact.experiments()[experiment].response[place].value;
            let mut add = |repeat: Option<usize>, value: Complex, std: f64| {
                rows.push(Row { experiment, harmonic, repeat, value, exact, std });
            };
            let mean_std = law.std_of(exact.norm());
            if measured.repeats.is_empty() {
                add(None, mean.value, mean_std);
            }
            let std = mean_std * (measured.repeats.len() as f64).sqrt();
            for (repeat, deviation) in measured.repeats.iter().enumerate() {
                add(Some(repeat), mean.value + deviation.response[place], std);
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use rand::SeedableRng;

    use super::super::fixtures::{LAW, exact_table, table};
    use super::*;

    fn drawn(share: f64, repeats: usize) -> Vec<BadRow> {
        let measurements = [&table(repeats), &exact_table()];
        BadRow::draw(share, measurements, &LAW, &mut ChaCha8Rng::seed_from_u64(3))
    }

    #[test]
    fn as_many_different_rows_are_drawn_as_the_share_asks_for_and_at_least_one() {
        let rows = |measured: &Measurement| rows([measured, &exact_table()], &LAW).len() as f64;
        for repeats in [0, 3] {
            let all = rows(&table(repeats));
            let bad = drawn(0.2, repeats);
            assert_eq!(bad.len(), (0.2 * all).round() as usize);
            let places: HashSet<_> =
                bad.iter().map(|row| (row.experiment, row.harmonic, row.repeat)).collect();
            assert_eq!(places.len(), bad.len());
            assert!(bad.iter().all(|row| row.repeat.is_some() == (repeats > 0)));
            assert_eq!(drawn(1e-6, repeats).len(), 1);
        }
    }

    #[test]
    fn errors_have_either_sign_and_a_size_within_their_range() {
        let bad = drawn(1.0, 3);
        assert!(bad.iter().any(|row| row.factor > 1.0) && bad.iter().any(|row| row.factor < 1.0));
        // Rounding of one minus a factor.
        let within = |row: &BadRow| (0.05 - 1e-9..=0.5 + 1e-9).contains(&(row.factor - 1.0).abs());
        assert!(bad.iter().all(within), "{bad:?}");
    }

    #[test]
    fn the_residual_of_a_repeat_is_relative_to_the_noise_of_one_repeat() {
        for repeats in [0, 4] {
            let measurement = table(repeats);
            for row in drawn(0.5, repeats) {
                let mut experiment = measurement.experiments()[row.experiment].clone();
                row.spoil(&mut experiment);
                let exact = exact_table().experiments()[row.experiment].clone();
                let exact = exact.harmonic(row.harmonic).unwrap().value;
                let std = LAW.floor * (repeats.max(1) as f64).sqrt();
                let sigmas = (value(&experiment, &row) - exact).norm() / std;
                assert!((row.sigmas / sigmas - 1.0).abs() < 1e-9, "{row:?} {sigmas}");
            }
        }
    }

    #[test]
    fn a_bad_repeat_changes_the_mean_and_leaves_the_values_of_the_other_repeats() {
        let mut experiment = table(3).experiments()[0].clone();
        let before = experiment.clone();
        let row = BadRow { experiment: 0, harmonic: 1, repeat: Some(2), factor: 1.3, sigmas: 9.0 };
        row.spoil(&mut experiment);
        let values = |of: &Experiment| {
            [0, 1, 2].map(|repeat| value(of, &BadRow { repeat: Some(repeat), ..row }))
        };
        let [old, new] = [values(&before), values(&experiment)];
        let near = |left: Complex, right: Complex| (left - right).norm() < 1e-12 * left.norm();
        assert!(near(new[0], old[0]) && near(new[1], old[1]) && near(new[2], old[2] * 1.3));
        let mean = (new[0] + new[1] + new[2]) / 3.0;
        assert!(near(experiment.harmonic(1).unwrap().value, mean));
        let sum: Complex = experiment.repeats.iter().map(|one| one.response[1]).sum();
        assert!(sum.norm() < 1e-12 * mean.norm());
        assert_eq!(experiment.response[2], before.response[2]);
    }

    fn value(experiment: &Experiment, row: &BadRow) -> Complex {
        let place = experiment.response.iter().position(|h| h.order == row.harmonic).unwrap();
        let deviation = row.repeat.map(|repeat| experiment.repeats[repeat].response[place]);
        experiment.response[place].value + deviation.unwrap_or_default()
    }
}
