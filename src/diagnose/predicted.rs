//! By how much one model predicts data better than another that neither has seen.

use std::collections::BTreeMap;

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::answers::{ComparedExperiment, ComparedHarmonic, Comparison, Gain, ValidatedModel};

/// Lines of a response from which on it is divided into blocks.
const FEWEST_LINES: usize = 20;

/// Ratio of the end of a block of lines to its beginning.
const BLOCK: f64 = 1.12;

/// Share of the largest line of an input above which a line counts as excited.
const EXCITED_SHARE: f64 = 0.02;

/// Experiment and harmonic.
pub(super) type Row = (usize, usize);

/// What is measured, and what a model makes of it.
pub(super) type Predicted = BTreeMap<Row, ComparedHarmonic>;

/// Everything that a model has a response for.
pub(super) fn predicted(comparison: &Comparison) -> Predicted {
    let rows = comparison
        .experiments
        .iter()
        .flat_map(|e| e.harmonics.iter().map(|h| ((e.experiment, h.order), *h)));
    rows.collect()
}

/// Squares of what a model leaves of some data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Left {
    /// Σ|Y − Ŷ|².
    error: f64,
    /// Σ|Y|².
    size: f64,
    /// Σ|Y − Ŷ|²/σ².
    chi2: f64,
    /// Real numbers compared.
    data: f64,
}

impl Left {
    fn of<'h>(harmonics: impl Iterator<Item = &'h ComparedHarmonic>) -> Self {
        let mut left = Self::default();
        for harmonic in harmonics {
            let ([re, im], [re_, im_]) = (harmonic.measured, harmonic.simulated);
            let error = (re - re_).powi(2) + (im - im_).powi(2);
            left.error += error;
            left.size += re * re + im * im;
            left.chi2 += error / harmonic.std.powi(2);
            left.data += if harmonic.order == 0 { 1.0 } else { 2.0 };
        }
        left
    }
}

/// How well a model predicts; nothing is said of what it has no response for.
pub(super) fn summary(predicted: &Predicted, noise_known: bool) -> ValidatedModel {
    let left = Left::of(predicted.values());
    ValidatedModel {
        nrmse: (left.size > 0.0).then(|| (left.error / left.size).sqrt()),
        rms: (left.error / predicted.len() as f64).sqrt(),
        chi2_per_dof: noise_known.then(|| left.chi2 / left.data),
        components: predicted.len(),
        unanswered: Vec::new(),
    }
}

/// The gain from one model's predictions to another's of the same rows, with the interval of
/// its ratio from how it varies over `groups`, which are in the order of something; `None`
/// where there is a single group, or nothing is left by one of the models.
///
/// Groups are a systematic sample of a field that is smooth from one to the next: what differs
/// between neighbours is chance. With b_g and a_g the Σ|Y − Ŷ|² of both models in group g of n
/// and x_g = b_g/mean(b) − a_g/mean(a),
///
/// ```text
///   Var(ln ratio) = ¼ · Σ(x_{g+1} − x_g)² / (2n(n − 1))
/// ```
///
/// the ¼ being that of the root, and Student's t has n − 1 degrees of freedom (Wolter 2007,
/// Introduction to Variance Estimation, doi:10.1007/978-0-387-35099-8, section 8.2).
pub(super) fn gain(
    before: &Predicted,
    after: &Predicted,
    groups: &BTreeMap<Row, usize>,
    noise_known: bool,
    heldout: String,
) -> Option<Gain> {
    let total = [before, after].map(|model| Left::of(model.values()));
    let [nrmse_before, nrmse_after] = total.map(|left| (left.error / left.size).sqrt());
    let ratio = nrmse_before / nrmse_after;
    let count = groups.values().max().map_or(0, |last| last + 1);
    if !(ratio > 0.0 && ratio.is_finite()) || count < 2 {
        return None;
    }
    let share = |model: &Predicted, total: Left| {
        let mut errors = vec![0.0; count];
        for (row, harmonic) in model {
            errors[groups[row]] += Left::of([harmonic].into_iter()).error;
        }
        errors.into_iter().map(move |error| error * count as f64 / total.error)
    };
    let [before, after] = [share(before, total[0]), share(after, total[1])];
    let shares: Vec<f64> = before.zip(after).map(|(before, after)| before - after).collect();
    let squares: f64 = shares.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    let n = count as f64;
    let std = 0.5 * (squares / (2.0 * n * (n - 1.0))).sqrt();
    let reach = StudentsT::new(0.0, 1.0, n - 1.0).ok()?.inverse_cdf(0.975) * std;
    let chi2 = total.map(|left| noise_known.then(|| left.chi2 / left.data));
    Some(Gain {
        heldout_nrmse_before: nrmse_before,
        heldout_nrmse_after: nrmse_after,
        ratio,
        interval95: [-1.0, 1.0].map(|side| ratio * (side * reach).exp()),
        chi2_per_dof_before: chi2[0],
        chi2_per_dof_after: chi2[1],
        heldout,
    })
}

/// Groups of rows in ascending order of frequency: experiments of the same fundamental, and of
/// an input with many lines blocks of neighbours. Where all have one frequency, groups are of
/// the same magnitude.
pub(super) fn groups(experiments: &[&ComparedExperiment]) -> BTreeMap<Row, usize> {
    let line = |e: &ComparedExperiment, order: usize| order.max(1) as f64 * e.omega_rad_s;
    let of_lines = experiments.iter().filter(|e| has_many_lines(e));
    let lowest = of_lines.flat_map(|e| e.harmonics.first().map(|h| line(e, h.order)));
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let level = |e: &ComparedExperiment, order: usize| match has_many_lines(e) {
        // The margin keeps a line on the edge of a block in it whatever the rounding.
        true => lowest * BLOCK.powf(((line(e, order) / lowest).ln() / BLOCK.ln() + 1e-9).floor()),
        false => e.omega_rad_s,
    };
    let by = |level: &dyn Fn(&ComparedExperiment, usize) -> f64| {
        let rows = experiments.iter().flat_map(|e| {
            e.harmonics.iter().map(move |h| ((e.experiment, h.order), level(e, h.order)))
        });
        let rows: Vec<(Row, f64)> = rows.collect();
        let mut levels: Vec<f64> = rows.iter().map(|(_, level)| *level).collect();
        levels.sort_by(f64::total_cmp);
        // Files round.
        levels.dedup_by(|b, a| *b - *a <= 1e-6 * a.abs());
        let group = |level: f64| levels.partition_point(|first| *first <= level) - 1;
        let groups = rows.iter().map(|(row, level)| (*row, group(*level)));
        (levels.len(), groups.collect::<BTreeMap<Row, usize>>())
    };
    let (frequencies, groups) = by(&level);
    if frequencies > 1 { groups } else { by(&|e, _| e.magnitude).1 }
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

    /// Experiments at these frequencies whose one harmonic is off by these errors.
    fn off(errors: &[f64]) -> Predicted {
        let harmonic = |(experiment, error): (usize, &f64)| {
            let harmonic = ComparedHarmonic {
                order: 1,
                input: [1.0, 0.0],
                measured: [1.0, 0.0],
                simulated: [1.0 - error, 0.0],
                std: 0.1,
            };
            ((experiment, 1), harmonic)
        };
        errors.iter().enumerate().map(harmonic).collect()
    }

    fn each_apart(count: usize) -> BTreeMap<Row, usize> {
        (0..count).map(|group| ((group, 1), group)).collect()
    }

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

    // By hand: b = (0.04, 0.01, 0.04), mean 0.03; a = (0.01, 0.01, 0.01);
    // x = (1/3, −2/3, 1/3), steps² = 2, Var = ¼·2/(2·3·2) = 1/24; t of 2 degrees at 0.975 is
    // 4.302653 (tables).
    #[test]
    fn the_interval_is_that_of_a_systematic_sample() {
        let (before, after) = (off(&[0.2, 0.1, 0.2]), off(&[0.1, 0.1, 0.1]));
        let gain = gain(&before, &after, &each_apart(3), true, String::new()).unwrap();
        let ratio = 3.0_f64.sqrt();
        assert!((gain.ratio - ratio).abs() < 1e-12, "{gain:?}");
        let reach = 4.302653 * (1.0_f64 / 24.0).sqrt();
        let [low, high] = gain.interval95;
        // The table has seven digits.
        assert!((low / (ratio * (-reach).exp()) - 1.0).abs() < 1e-6, "{gain:?}");
        assert!((high / (ratio * reach.exp()) - 1.0).abs() < 1e-6, "{gain:?}");
        // (0.03·3)/0.1²/6 real numbers.
        assert!((gain.chi2_per_dof_before.unwrap() - 1.5).abs() < 1e-12, "{gain:?}");
    }

    #[test]
    fn a_single_group_or_nothing_left_gives_no_gain() {
        let some = off(&[0.1, 0.2]);
        let one = (0..2).map(|e| ((e, 1), 0)).collect();
        assert_eq!(gain(&some, &some, &one, true, String::new()), None);
        let none = off(&[0.0, 0.0]);
        assert_eq!(gain(&some, &none, &each_apart(2), true, String::new()), None);
        assert_eq!(gain(&none, &some, &each_apart(2), true, String::new()), None);
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
    fn lines_are_in_blocks_of_the_same_ratio_and_none_is_empty() {
        let groups = grouped(&[experiment(0, 1.0, 2.0, 100)]);
        let of = |order: usize| groups[&(0, order)];
        assert_eq!([of(0), of(1), of(2)], [0, 0, 1]);
        assert!((1..100).all(|k| of(k + 1) - of(k) <= 1), "{groups:?}");
        // ln(100)/ln(1.12) is 40.6: the last block ends beyond the last line.
        let last: Vec<usize> = (1..=100).filter(|k| of(*k) == of(100)).collect();
        assert!((100.0 / last[0] as f64) < BLOCK, "{last:?}");
    }
}
