//! Sentences that report the results of a validation.

mod motions;

use std::f64::consts::TAU;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::answers::{
    Answer, Cause, ComparedExperiment, Comparison, Gain, ValidatedModel, ValidatedModels, Verdict,
};
use crate::diagnose::residuals::sentence::rounded;
use crate::identify::UnitCompatibility;
use crate::measurement::{Measurement, after_number};

use super::hurts;

pub(crate) use motions::of_motions;

/// p-value of χ² below which a model leaves more than noise. It is small because parameters that
/// were fitted to other data err a little, which is no fault of the model. Tuned.
const MORE_THAN_NOISE: f64 = 1e-3;

/// Results of both models on the other measurement.
pub(crate) struct Tried<'a> {
    pub causes: &'a [Cause],
    pub models: &'a ValidatedModels,
    pub gain: Option<&'a Gain>,
    /// Verdict before and after the validation.
    pub verdicts: Option<(Verdict, Verdict)>,
    pub noise_known: bool,
}

impl Tried<'_> {
    /// The sentences, that on the gain first.
    pub fn remarks(&self) -> Vec<String> {
        let ValidatedModels { base, extended } = self.models;
        let mut said = vec![self.gained()];
        let (richest, name) = match extended {
            Some(extended) => (extended, "the model with the causes"),
            None => (base, "the base model"),
        };
        if leaves_more_than_noise(richest) {
            let each = richest.chi2_per_dof.unwrap_or_default();
            said.push(format!(
                "the residual of {name} is larger than the noise of this measurement: χ² is \
                 {each:.3} per value"
            ));
        }
        if !self.noise_known {
            said.push(
                "this measurement does not state its noise (no std, no repeats), so whether a \
                 residual is noise cannot be told"
                    .into(),
            );
        }
        let lost = |model: &ValidatedModel| model.unanswered.len();
        let lost = [Some(base), extended.as_ref()].map(|model| model.map_or(0, lost));
        let who = match lost {
            [0, 0] => None,
            [some, 0] => Some((some, "the base model")),
            [0, some] => Some((some, "the model with the causes")),
            [one, other] => Some((one.max(other), "a model")),
        };
        if let Some((count, who)) = who {
            let plural = if count == 1 { "experiment" } else { "experiments" };
            said.push(format!(
                "{who} has no response to {count} {plural}, which are left out for both models"
            ));
        }
        said
    }

    /// The sentence on the gain of the causes.
    fn gained(&self) -> String {
        let Self { causes, models, gain, verdicts, .. } = self;
        let per_cent = |nrmse: Option<f64>| {
            nrmse.map_or("all".to_owned(), |nrmse| format!("{} %", rounded(100.0 * nrmse, 3)))
        };
        let before = per_cent(models.base.nrmse);
        let Some(extended) = &models.extended else {
            return format!(
                "the residual of the base model is {before} of the response; no cause is named, so \
                 there is no improvement to measure"
            );
        };
        let names: Vec<&str> = causes.iter().map(|cause| cause.effect.as_str()).collect();
        let (names, s) = (names.join(" and "), if causes.len() > 1 { "" } else { "s" });
        let left = format!(
            "the residual is {before} of the response without, {} with",
            per_cent(extended.nrmse)
        );
        let Some(gain) = gain else {
            return format!(
                "it is not known whether {names} help{s} here: {left}. The ratio has no interval, \
                 because there is only one frequency and one magnitude, or the residual is zero"
            );
        };
        let [low, high] = gain.interval95;
        let (sign, [ratio, low, high]) = match gain.ratio < 1.0 {
            true => ('×', [gain.ratio, high, low].map(|value| 1.0 / value)),
            false => ('÷', [gain.ratio, low, high]),
        };
        let [ratio, low, high] = [ratio, low, high].map(|value| rounded(value, 3));
        let ratio = format!("residual {sign} {ratio}, 95 % interval {low} to {high}");
        if !hurts(gain) {
            return match gain.interval95[0] > 1.0 {
                true => format!("{names} help{s} here, too: {left} ({ratio})"),
                false => format!("it is not known whether {names} help{s} here: {left} ({ratio})"),
            };
        }
        let text = format!(
            "{names} help{s} on the fitted data and make{s} the prediction worse here: {left} ({ratio})"
        );
        match verdicts {
            Some((before, after)) if before != after => {
                let name = |verdict: &Verdict| format!("{verdict:?}").to_uppercase();
                format!(
                    "{text}; the verdict is therefore {} instead of {}",
                    name(after),
                    name(before)
                )
            }
            _ => text,
        }
    }
}

fn leaves_more_than_noise(model: &ValidatedModel) -> bool {
    model.chi2_per_dof.is_some_and(|each| {
        // Two real numbers for each component. Means have one; the few more hardly matter.
        let data = 2.0 * model.components as f64;
        let law = ChiSquared::new(data).map(|law| law.sf(each * data));
        law.is_ok_and(|p| p < MORE_THAN_NOISE)
    })
}

/// Remarks on the data: whether they were fitted, their units, their order of acquisition.
pub(crate) fn of_data(
    answer: &Answer,
    measurement: &Measurement,
    agreement: &UnitCompatibility,
) -> Vec<String> {
    let mut said = Vec::new();
    let fitted = &answer.base().provenance.data_sha256;
    if !fitted.is_empty() && fitted == measurement.sha256() {
        said.push(
            "these are the data that the answer was fitted to: an improvement on them proves \
             nothing"
                .into(),
        );
    }
    if let UnitCompatibility::Unsaid { quantity } = agreement {
        said.push(format!(
            "one of the two measurements does not say the unit of its {quantity}; it is taken to \
             be the other\'s"
        ));
    }
    if answer.causes().iter().any(|cause| cause.effect == "friction_drift") {
        let runs = measurement.experiments().iter().map(|e| e.run);
        let mut runs = runs.chain(measurement.transients().iter().map(|t| t.run));
        let known = runs.all(|run| run.is_some());
        said.push(match known {
            true => "friction_drift is assumed to run the same course in this measurement as in \
                     the one that was fitted, from its first run to its last; it may not"
                .into(),
            false => "this measurement does not state its order of acquisition: friction is \
                      assumed to be that of the first run of the one that was fitted"
                .into(),
        });
    }
    said
}

/// What was held out, in words.
pub(crate) fn heldout(comparison: &Comparison, experiments: &[&ComparedExperiment]) -> String {
    let highest = |e: &&ComparedExperiment| {
        let excited = e.harmonics.iter().filter(|h| h.input != [0.0, 0.0]).map(|h| h.order);
        excited.max().unwrap_or(1).max(1) as f64 * e.omega_rad_s / TAU
    };
    let magnitudes = range(experiments.iter().map(|e| e.magnitude));
    let fundamentals = experiments.iter().map(|e| e.omega_rad_s / TAU);
    let frequencies = range(fundamentals.chain(experiments.iter().map(highest)));
    let plural = if experiments.len() == 1 { "experiment" } else { "experiments" };
    let unit = after_number(&comparison.input_unit);
    format!(
        "a second measurement: {} {plural}, magnitude {magnitudes}{unit}, {frequencies} Hz",
        experiments.len()
    )
}

/// The smallest and the largest of some positive values.
fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(0.0, f64::max);
    // Values in files are rounded.
    if high - low <= 1e-6 * high { format!("{low:.4}") } else { format!("{low:.4} to {high:.4}") }
}
