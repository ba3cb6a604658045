//! Predictions of models for held-out data, and the groups over which their errors are averaged.
//!
//! Errors of neighbouring lines resemble each other, so lines are grouped into blocks.

use std::collections::BTreeMap;

use crate::answers::{ComparedExperiment, ComparedHarmonic, Comparison};
use crate::measurement::EXCITED_SHARE;

/// Fewest lines of a response for which they are grouped into blocks.
pub(crate) const FEWEST_LINES: usize = 20;

/// Ratio of the highest to the lowest frequency of a block of lines. Tuned.
const BLOCK_FREQUENCY_RATIO: f64 = 1.12;

/// Index of the experiment, and harmonic.
pub(crate) type Row = (usize, usize);

/// Measured and predicted value of each row.
pub(crate) type Predicted = BTreeMap<Row, ComparedHarmonic>;

/// The rows of a comparison: everything for which the model has a response.
pub(crate) fn predicted(comparison: &Comparison) -> Predicted {
    let rows = comparison
        .experiments
        .iter()
        .flat_map(|e| e.harmonics.iter().map(|h| ((e.experiment, h.order), *h)));
    rows.collect()
}

/// The group of every row, numbered by ascending frequency: experiments of the same fundamental, or
/// blocks of neighbouring lines. If all have one frequency, a group is a magnitude.
pub(crate) fn groups(experiments: &[&ComparedExperiment]) -> BTreeMap<Row, usize> {
    let line = |e: &ComparedExperiment, order: usize| order.max(1) as f64 * e.omega_rad_s;
    let of_lines = experiments.iter().filter(|e| has_many_lines(e));
    let lowest = of_lines.flat_map(|e| e.harmonics.first().map(|h| line(e, h.order)));
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let level = |e: &ComparedExperiment, order: usize| match has_many_lines(e) {
        true => lowest * BLOCK_FREQUENCY_RATIO.powi(block(line(e, order) / lowest) as i32),
        false => e.omega_rad_s,
    };
    let by = |level: &dyn Fn(&ComparedExperiment, usize) -> f64| {
        let rows = experiments.iter().flat_map(|e| {
            e.harmonics.iter().map(move |h| ((e.experiment, h.order), level(e, h.order)))
        });
        let rows: Vec<(Row, f64)> = rows.collect();
        let mut levels: Vec<f64> = rows.iter().map(|(_, level)| *level).collect();
        levels.sort_by(f64::total_cmp);
        // Values in files are rounded.
        levels.dedup_by(|b, a| *b - *a <= 1e-6 * a.abs());
        let group = |level: f64| levels.partition_point(|first| *first <= level) - 1;
        let groups = rows.iter().map(|(row, level)| (*row, group(*level)));
        (levels.len(), groups.collect::<BTreeMap<Row, usize>>())
    };
    let (frequencies, groups) = by(&level);
    if frequencies > 1 { groups } else { by(&|e, _| e.magnitude).1 }
}

/// The number of the block of a line; `ratio` is its frequency over that of the lowest line.
pub(crate) fn block(ratio: f64) -> usize {
    // The margin keeps a line at the lower edge of a block in that block despite rounding.
    (ratio.ln() / BLOCK_FREQUENCY_RATIO.ln() + 1e-9).floor() as usize
}

fn has_many_lines(experiment: &ComparedExperiment) -> bool {
    let size = |h: &ComparedHarmonic| h.input[0].hypot(h.input[1]);
    let lines = || experiment.harmonics.iter().filter(|h| h.order > 0);
    let largest = lines().map(size).fold(0.0, f64::max);
    let excited = lines().filter(|h| size(h) > EXCITED_SHARE * largest).count();
    excited > 1 && lines().count() >= FEWEST_LINES
}

#[cfg(test)]
mod tests {
    use super::*;

    fn experiment(index: usize, magnitude: f64, omega: f64, lines: usize) -> ComparedExperiment {
        let harmonic = |order: usize| ComparedHarmonic {
            order,
            input: [if lines > 1 || order == 1 { 1.0 } else { 0.0 }, 0.0],
            measured: [1.0, 0.0],
            simulated: [1.0, 0.0],
            std: 1.0,
        };
        ComparedExperiment {
            experiment: index,
            magnitude,
            omega_rad_s: omega,
            run: None,
            harmonics: (0..=lines.max(3)).map(harmonic).collect(),
        }
    }

    fn grouped(experiments: &[ComparedExperiment]) -> BTreeMap<Row, usize> {
        groups(&experiments.iter().collect::<Vec<_>>())
    }

    #[test]
    fn experiments_of_one_frequency_are_a_group_at_any_magnitude() {
        let groups = grouped(&[
            experiment(0, 1.0, 5.0, 1),
            experiment(1, 2.0, 1.0, 1),
            experiment(2, 2.0, 5.0 + 1e-9, 1),
        ]);
        let of = |e: usize| [0, 1, 3].map(|order| groups[&(e, order)]);
        assert_eq!([of(0), of(1), of(2)], [[1; 3], [0; 3], [1; 3]]);
    }

    #[test]
    fn at_one_frequency_a_magnitude_is_a_group() {
        let groups = grouped(&[experiment(0, 2.0, 5.0, 1), experiment(1, 1.0, 5.0, 1)]);
        assert_eq!((groups[&(0, 1)], groups[&(1, 1)]), (1, 0));
    }

    #[test]
    fn lines_are_in_blocks_of_equal_frequency_ratio_and_no_block_is_empty() {
        let groups = grouped(&[experiment(0, 1.0, 2.0, 100)]);
        let of = |order: usize| groups[&(0, order)];
        assert_eq!([of(0), of(1), of(2)], [0, 0, 1]);
        assert!((1..100).all(|k| of(k + 1) - of(k) <= 1), "{groups:?}");
        // ln(100)/ln(1.12) = 40.6: the last block extends beyond the last line.
        let last: Vec<usize> = (1..=100).filter(|k| of(*k) == of(100)).collect();
        assert!((100.0 / last[0] as f64) < BLOCK_FREQUENCY_RATIO, "{last:?}");
    }
}
