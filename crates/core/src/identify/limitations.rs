//! Sentences for the user about what a measurement cannot determine.

use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use crate::answers::{Fit, IdentifyOptions, Method, NoiseSource, Weighting};
use crate::measurement::Measurement;

use super::pipeline::Fitted;
use super::problem::Problem;
use super::summary::Summary;

/// Most remarks on the uploaded file that are repeated in an answer (tuned): a stepped sine has
/// some for every segment.
const MOST_NOTES: usize = 6;

/// The sentences; empty if nothing is missing.
pub(super) fn of(
    measurement: &Measurement,
    problem: &Problem,
    method: Method,
    options: &IdentifyOptions,
    fitted: &Fitted,
    summary: &Summary,
) -> Vec<String> {
    let mut sentences: Vec<String> = measurement.notes().iter().take(MOST_NOTES).cloned().collect();
    if measurement.notes().len() > MOST_NOTES {
        let more = measurement.notes().len() - MOST_NOTES;
        sentences.push(format!("… and {more} more remarks on what was read, with the measurement"));
    }
    let mut say = |sentence: String| sentences.push(sentence);
    if method == Method::TwoMagnitude {
        say("the method two-magnitude does not fit the data: its parameters may be wrong by several \
             per cent, more with noise or near breakaway, and the intervals do not include this \
             error. Use another method, such as abc-ann"
            .into());
    }
    if problem.tied_friction {
        say("without harmonic 0 or even harmonics only the mean of forward and backward friction \
             (fc_mean) can be found; the fit allows either to be up to twice the other; measure \
             harmonics 0 to 5"
            .into());
    }
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    let mut magnitudes: Vec<f64> = measurement.experiments().iter().map(|e| e.magnitude).collect();
    magnitudes.sort_by(f64::total_cmp);
    magnitudes.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * b.abs());
    if cosines && magnitudes.len() == 1 {
        say("a single magnitude tells friction from viscous damping only by the shape of the \
             response; add a second magnitude, two to four times this one"
            .into());
    }
    let highest = measurement.experiments().iter().map(|e| e.highest_harmonic()).max();
    if cosines && highest.is_some_and(|highest| highest < 3) {
        say("fundamentals alone cannot show gain asymmetry, offset, dead zone or drag; harmonics \
             0 to 5 and a third magnitude would"
            .into());
    }
    if options.weights == Weighting::Response {
        say("every harmonic has the same weight, whatever its noise (option weights): the fit \
             cannot be judged"
            .into());
    } else if fitted.weights.source == NoiseSource::Estimated {
        if measurement.experiments().iter().any(|e| e.has_repeats()) {
            say("the repeats are copies of each other, and say nothing about the noise".into());
        }
        say(
            "the size of the noise is unknown: the fit cannot be judged; give std, repeats or the \
             option noise_std"
                .into(),
        );
    } else if options.noise_std.is_some()
        && (fitted.weights.scale_dof.is_finite()
            || measurement.experiments().iter().flat_map(|e| &e.response).any(|h| h.std.is_some()))
    {
        say("noise_std was not used: the file states its own noise".into());
    }
    if let Some(factor) = excessive_std(fitted.weights.source, &summary.fit) {
        say(format!(
            "the residual is {factor:.3} times the stated noise: std is probably {:.1} times too \
             large, which hides what the model lacks; correct it, or remove it to have the noise \
             estimated from the residual",
            1.0 / factor
        ));
    }
    if summary.fit.uncertainty_scale > 1.0 {
        say(format!(
            "the base model does not fit to within the noise: the standard deviations of its \
             parameters were widened by the factor {:.3}, and the parameters are biased by what \
             the model lacks",
            summary.fit.uncertainty_scale
        ));
    }
    let unidentified = summary.parameters.iter().filter(|(_, estimate)| !estimate.identifiable);
    let mut names: Vec<&str> = unidentified.map(|(name, _)| name.as_str()).collect();
    if problem.tied_friction {
        names.retain(|name| !name.starts_with("fc_"));
    }
    if !names.is_empty() {
        say(format!("these data do not determine {}", names.join(", ")));
    }
    sentences
}

/// Largest share of the stated standard deviation that a model leaves where std is called too
/// large: a smaller error hides no more than half of an effect.
const LARGEST_LEFT_SHARE: f64 = 0.5;

/// Probability of residuals as small as they are by chance below which std is called too large.
const CHANCE_LEVEL: f64 = 1e-6;

/// The ratio of what a model leaves to the standard deviations that the upload states, where it is
/// too small to be chance by a χ² test.
fn excessive_std(source: NoiseSource, fit: &Fit) -> Option<f64> {
    let chi2 = fit.chi2.filter(|_| source == NoiseSource::Given)?;
    let by_chance = ChiSquared::new(fit.dof as f64).ok()?.cdf(chi2);
    let ratio = fit.chi2_per_dof?.sqrt();
    (by_chance < CHANCE_LEVEL && ratio < LARGEST_LEFT_SHARE).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(chi2: f64, dof: i64) -> Fit {
        Fit {
            chi2: Some(chi2),
            dof,
            chi2_per_dof: (dof > 0).then(|| chi2 / dof as f64),
            nrmse: 0.01,
            rms_residual: 0.01,
            p_value: Some(1.0),
            adequate: Some(true),
            uncertainty_scale: 1.0,
            unanswered: Vec::new(),
            noise_law: None,
        }
    }

    // A std of 30 times the true one leaves χ² near dof/900.
    #[test]
    fn a_stated_deviation_far_above_the_residuals_is_said_to_be_too_large() {
        let told = |chi2, dof| excessive_std(NoiseSource::Given, &fit(chi2, dof));
        let ratio = told(158.0 / 900.0, 158).unwrap();
        assert!((ratio - 1.0 / 30.0).abs() < 1e-12);
        assert_eq!(told(150.0, 158), None);
        // Chance: two residuals of which one is small.
        assert_eq!(told(0.02, 2), None);
        assert_eq!(told(0.0, 0), None);
        assert_eq!(excessive_std(NoiseSource::Repeats, &fit(0.2, 158)), None);
    }
}
