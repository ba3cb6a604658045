//! The gain of one model over another: the ratio of their errors (NRMSE) on held-out data.
//!
//! The interval of the ratio comes from how the errors vary between groups of data: [`Sample`].

mod residual_sums;
mod variance_estimation;

use std::collections::BTreeMap;

use crate::answers::{Gain, ValidatedModel};

use super::heldout_predictions::{Predicted, Row};
pub(crate) use residual_sums::ResidualSums;
pub(crate) use variance_estimation::Sample;
use variance_estimation::{jackknife_std, smooth_std, student};

/// Summary of a model's predictions; `unanswered` is left empty.
pub(crate) fn summary(predicted: &Predicted, noise_known: bool) -> ValidatedModel {
    summary_of(&ResidualSums::of(predicted.values()), predicted.len(), noise_known)
}

/// The same from sums over this number of components.
pub(crate) fn summary_of(
    left: &ResidualSums,
    components: usize,
    noise_known: bool,
) -> ValidatedModel {
    ValidatedModel {
        nrmse: Some(left.nrmse()).filter(|error| error.is_finite()),
        rms: (left.error / components as f64).sqrt(),
        chi2_per_dof: noise_known.then(|| left.chi2 / left.data),
        components,
        unanswered: Vec::new(),
    }
}

/// The gain of the predictions `after` over those `before`, with its interval by [`Sample::Smooth`]
/// over `groups`. Rows that only one of them has are left out. `None` if there is a single group,
/// or one of the models leaves no error.
pub(crate) fn gain(
    before: &Predicted,
    after: &Predicted,
    groups: &BTreeMap<Row, usize>,
    noise_known: bool,
    mut heldout: String,
) -> Option<Gain> {
    let both: Vec<Row> = before.keys().filter(|row| after.contains_key(row)).copied().collect();
    let lost = before.len() - both.len();
    if lost > 0 {
        heldout.push_str(&format!(
            "; {lost} harmonics are left out because one of the models does not predict them"
        ));
    }
    let mut by_group: BTreeMap<usize, [ResidualSums; 2]> = BTreeMap::new();
    for row in &both {
        let group = by_group.entry(groups[row]).or_default();
        group[0].add(&before[row]);
        group[1].add(&after[row]);
    }
    let by_group: Vec<[ResidualSums; 2]> = by_group.into_values().collect();
    gain_of_groups(&by_group, Sample::Smooth, noise_known, heldout)
}

/// The same from the sums of both models in each group.
pub(crate) fn gain_of_groups(
    groups: &[[ResidualSums; 2]],
    sample: Sample,
    noise_known: bool,
    heldout: String,
) -> Option<Gain> {
    let total =
        [0, 1].map(|model: usize| ResidualSums::sum(groups.iter().map(|group| &group[model])));
    let ratio = total[0].nrmse() / total[1].nrmse();
    if !(ratio > 0.0 && ratio.is_finite()) || groups.len() < 2 {
        return None;
    }
    let std = match sample {
        Sample::Smooth => smooth_std(groups),
        Sample::Independent => jackknife_std(groups, &total),
    };
    let half_width = student(groups.len())? * std;
    if !half_width.is_finite() {
        return None;
    }
    let chi2 = total.map(|left| noise_known.then(|| left.chi2 / left.data));
    Some(Gain {
        heldout_nrmse_before: total[0].nrmse(),
        heldout_nrmse_after: total[1].nrmse(),
        ratio,
        interval95: [-1.0, 1.0].map(|side| ratio * (side * half_width).exp()),
        chi2_per_dof_before: chi2[0],
        chi2_per_dof_after: chi2[1],
        heldout,
    })
}

/// NRMSE of predictions; `None` if it is not finite.
pub(crate) fn error(predicted: &Predicted) -> Option<f64> {
    Some(ResidualSums::of(predicted.values()).nrmse()).filter(|error| error.is_finite())
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;
    use crate::answers::ComparedHarmonic;

    /// A group of `rows` rows for each error: 1 is measured, the simulated value wrong by the
    /// error.
    fn predicted(errors: &[f64], rows: usize) -> (Predicted, BTreeMap<Row, usize>) {
        let all = || (0..errors.len()).flat_map(|group| (0..rows).map(move |order| (group, order)));
        let harmonic = |(group, order): Row| ComparedHarmonic {
            order: order + 1,
            input: [1.0, 0.0],
            measured: [1.0, 0.0],
            simulated: [1.0 - errors[group], 0.0],
            std: 0.1,
        };
        (all().map(|row| (row, harmonic(row))).collect(), all().map(|row| (row, row.0)).collect())
    }

    #[test]
    fn the_gain_is_the_ratio_of_the_errors_over_all_rows() {
        let (before, groups) = predicted(&[0.3, 0.4], 5);
        let (after, _) = predicted(&[0.1, 0.1], 5);
        let gain = gain(&before, &after, &groups, true, "frequencies".into()).unwrap();
        let nrmse = (0.5_f64 * (0.09 + 0.16)).sqrt();
        assert!((gain.heldout_nrmse_before - nrmse).abs() < 1e-12);
        assert!((gain.ratio - nrmse / 0.1).abs() < 1e-12);
        // The squared error 0.01 over the variance 0.1², shared by re and im.
        assert!((gain.chi2_per_dof_after.unwrap() - 0.5).abs() < 1e-12);
        assert!(gain.interval95[0] < gain.ratio && gain.ratio < gain.interval95[1]);
    }

    #[test]
    fn rows_that_one_model_cannot_predict_are_left_out_of_both_and_counted() {
        let (before, groups) = predicted(&[0.3, 0.3, 0.3], 2);
        let (mut after, _) = predicted(&[0.1, 0.1, 9.0], 2);
        after.retain(|row, _| row.0 < 2);
        let gain = gain(&before, &after, &groups, false, "lines".into()).unwrap();
        assert!((gain.ratio - 3.0).abs() < 1e-12);
        let left_out = "2 harmonics are left out because one of the models does not predict them";
        assert_eq!(gain.heldout, format!("lines; {left_out}"));
        assert_eq!(gain.chi2_per_dof_before, None);
    }

    /// Experiments with one harmonic each, whose simulated value is wrong by these errors.
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

    fn one_group_each(count: usize) -> BTreeMap<Row, usize> {
        (0..count).map(|group| ((group, 1), group)).collect()
    }

    // By hand: b = (0.04, 0.01, 0.04), mean 0.03; a = (0.01, 0.01, 0.01);
    // x = (1/3, −2/3, 1/3), steps² = 2, Var = ¼·2/(2·3·2) = 1/24; t of 2 degrees at 0.975 is
    // 4.302653 (tables).
    #[test]
    fn the_interval_is_that_of_a_systematic_sample() {
        let (before, after) = (off(&[0.2, 0.1, 0.2]), off(&[0.1, 0.1, 0.1]));
        let gain = gain(&before, &after, &one_group_each(3), true, String::new()).unwrap();
        let ratio = 3.0_f64.sqrt();
        assert!((gain.ratio - ratio).abs() < 1e-12, "{gain:?}");
        let half_width = 4.302653 * (1.0_f64 / 24.0).sqrt();
        let [low, high] = gain.interval95;
        // The tabulated t has seven digits.
        assert!((low / (ratio * (-half_width).exp()) - 1.0).abs() < 1e-6, "{gain:?}");
        assert!((high / (ratio * half_width.exp()) - 1.0).abs() < 1e-6, "{gain:?}");
        // Σb/σ² = 0.03·3/0.1² over six real numbers.
        assert!((gain.chi2_per_dof_before.unwrap() - 1.5).abs() < 1e-12, "{gain:?}");
    }

    // By hand: without each group in turn the ratio of squares is 5/2, 8/2 and 5/2, and half its
    // logarithm is 0.458145, 0.693147 and 0.458145. Their mean is 0.536479, the sum of squares
    // about it 0.036817, and √(2/3·0.036817) = 0.156668.
    #[test]
    fn independent_groups_are_left_out_one_by_one() {
        let left = |error: f64| ResidualSums { error, size: 1.0, chi2: 0.0, data: 1.0 };
        let groups = [4.0, 1.0, 4.0].map(|error| [left(error), left(1.0)]);
        let gain = |groups: &[[ResidualSums; 2]]| {
            gain_of_groups(groups, Sample::Independent, false, String::new())
        };
        let [low, high] = gain(&groups).unwrap().interval95;
        let width = (high / low).ln() / (2.0 * 4.302653);
        assert!((width - 0.156668).abs() < 1e-6, "{width}");
        assert_eq!(gain(&[[left(1.0), left(1.0)], [left(0.0), left(0.0)]]), None);
    }

    #[test]
    fn a_single_group_or_nothing_left_gives_no_gain() {
        let some = off(&[0.1, 0.2]);
        let one = (0..2).map(|e| ((e, 1), 0)).collect();
        assert_eq!(gain(&some, &some, &one, true, String::new()), None);
        let none = off(&[0.0, 0.0]);
        assert_eq!(gain(&some, &none, &one_group_each(2), true, String::new()), None);
        assert_eq!(gain(&none, &some, &one_group_each(2), true, String::new()), None);
    }

    // In 400 trials a share of 95 % has a standard deviation of 1.1 %. Three of those are allowed,
    // and a little more, because squared errors are far from normal.
    #[test]
    fn the_interval_covers_the_true_ratio_in_95_percent_of_draws() {
        let rng = &mut ChaCha8Rng::seed_from_u64(5);
        let mut held = 0;
        for _ in 0..400 {
            let mut drawn = |std: f64| -> Vec<f64> {
                (0..30).map(|_| std * rng.sample::<f64, _>(StandardNormal)).collect()
            };
            let ((before, groups), (after, _)) =
                (predicted(&drawn(0.6), 1), predicted(&drawn(0.2), 1));
            let [low, high] =
                gain(&before, &after, &groups, true, String::new()).unwrap().interval95;
            held += u32::from((low..=high).contains(&3.0));
        }
        assert!((366..=394).contains(&held), "{held} of 400");
    }

    #[test]
    fn slow_variation_over_the_groups_does_not_widen_the_interval() {
        let smooth: Vec<f64> = (0..16).map(|i| 0.1 + 0.02 * f64::from(i)).collect();
        let mut mixed = smooth.clone();
        // Swap every second value of the first half with its mirror image.
        (0..8).step_by(2).for_each(|i| mixed.swap(i, 15 - i));
        let width = |errors: &[f64]| {
            let ((before, groups), (after, _)) = (predicted(errors, 3), predicted(&[0.05; 16], 3));
            let [low, high] =
                gain(&before, &after, &groups, true, String::new()).unwrap().interval95;
            (high / low).ln()
        };
        assert!(width(&smooth) < 0.3 * width(&mixed));
    }
}
