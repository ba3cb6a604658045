//! The report on where a base model departs from its data: tests, patterns, groups, a sentence.

use crate::answers::{Discrepancy, NoiseSource, Pattern, ResidualTest};
use crate::identify::{FitSession, Intervals, Model, ModelFit};
use crate::measurement::after_number;
use crate::observer::Observer;

use super::groups;
use super::groups::Sizes;
use super::layout::Cell;
use super::patterns;
use super::regions::Regions;
use super::residual::Residuals;
use super::sentence;
use super::statistics;
use super::whiteness::{Judgement, Nulls};

/// Where the noise is unknown, residuals of at most this share of the response (rms) are rounding
/// errors of the upload and the solver.
const ROUNDING_SHARE: f64 = 1e-6;

/// The same for a model with effects, whose simulation rounds more.
const EXTENDED_ROUNDING_SHARE: f64 = 2e-5;

/// Reports where a fitted base model departs from its data; wrongly once the observer cancels.
pub(crate) fn of(fit: &ModelFit, seed: u64, observer: &dyn Observer) -> Discrepancy {
    let residuals = Residuals::of(fit);
    let regions = Regions::new(&residuals.layout, &residuals.freedom);
    let statistics = statistics::all(&residuals, &regions);
    let nulls = Nulls::draw(&residuals, &statistics, seed, observer);
    let judgement = nulls.judge(&statistics, &residuals.values);
    let rounding = is_rounding(&residuals, ROUNDING_SHARE);
    let contradiction = contradiction(fit, &residuals);
    let passed = rounding || judgement.noise_like;
    let noise_like = contradiction.is_none() && passed;
    let patterns = match passed {
        true => Vec::new(),
        false => patterns::find(&residuals, &regions, judgement.region_limit),
    };
    let sentence = if let Some(sentence) = contradiction.filter(|_| patterns.is_empty()) {
        sentence
    } else if judgement.tests.iter().all(|test| test.p_value.is_none()) {
        "there are too few data to test whether the simulation is wrong".into()
    } else if rounding {
        "the simulation agrees with the measurement to the last digits: the residual is rounding"
            .into()
    } else if noise_like {
        adequate_sentence(&residuals, &judgement)
    } else {
        wrong_sentence(&patterns, &judgement)
    };
    Discrepancy {
        sentence,
        noise_like,
        tests: judgement.tests,
        patterns,
        by_magnitude: groups::by_magnitude(&residuals),
        by_frequency: groups::by_frequency(&residuals),
        by_harmonic: groups::by_harmonic(&residuals),
        by_run: groups::by_run(&residuals),
    }
}

/// Whether a model leaves only noise of a session's data, as far as it has a response to them; at random
/// once the observer cancels.
pub(crate) fn leaves_noise(session: &FitSession<'_>, model: &Model, seed: u64) -> bool {
    let fit = session.judge(model, Intervals::Curvature);
    fit.is_ok_and(|fit| is_noise(&fit, seed, session.observer()))
}

/// Whether the residuals of an extended model are noise; at random once the observer cancels.
pub(crate) fn is_noise(fit: &ModelFit, seed: u64, observer: &dyn Observer) -> bool {
    let residuals = Residuals::of(fit);
    if contradiction(fit, &residuals).is_some() {
        return false;
    }
    if is_rounding(&residuals, EXTENDED_ROUNDING_SHARE) {
        return true;
    }
    is_without_structure(&residuals, seed, observer)
}

/// Whether residuals have no structure, be they of the size of the noise or, unless that is known, of
/// another; at random once the observer cancels.
pub(crate) fn is_without_structure(
    residuals: &Residuals,
    seed: u64,
    observer: &dyn Observer,
) -> bool {
    let regions = Regions::new(&residuals.layout, &residuals.freedom);
    let statistics = statistics::all(residuals, &regions);
    let nulls = Nulls::draw_unless_certain(residuals, &statistics, seed, observer);
    nulls.is_some_and(|nulls| nulls.judge(&statistics, &residuals.values).noise_like)
}

/// Why the residuals of a model cannot be noise, whatever their structure; `None` if they can.
fn contradiction(fit: &ModelFit, residuals: &Residuals) -> Option<String> {
    let cells: Vec<&Cell> = residuals.layout.cells.iter().collect();
    let sizes = Sizes::of(residuals, &cells)?;
    if sizes.rms_left > sizes.rms_simulated {
        return Some(
            "the residual is larger than the simulated response: the response is not that of an \
             axis to this input, or is lost in noise"
                .into(),
        );
    }
    let ratio = fit.contradicts_noise?;
    Some(format!(
        "the simulation is wrong: the residual is {} times the stated noise, in no pattern",
        sentence::short(ratio.sqrt())
    ))
}

/// Whether the residuals are rounding errors; never so where the noise is known.
fn is_rounding(residuals: &Residuals, share: f64) -> bool {
    let cells: Vec<&Cell> = residuals.layout.cells.iter().collect();
    let sizes = Sizes::of(residuals, &cells);
    !residuals.scale_known && sizes.is_none_or(|sizes| sizes.rms_left <= share * sizes.rms_measured)
}

/// The sentence for a wrong model.
fn wrong_sentence(patterns: &[Pattern], judgement: &Judgement) -> String {
    let failed: Vec<&ResidualTest> = judgement.tests.iter().filter(|test| !test.passed).collect();
    match patterns.first() {
        Some(pattern) => format!(
            "the simulation is wrong: {}; {:.0} % of the excess χ² lies there",
            pattern.sentence,
            100.0 * pattern.share
        ),
        None => {
            let means: Vec<&str> = failed.iter().map(|test| test.explanation.as_str()).collect();
            format!("the simulation is wrong: {}", means.join("; "))
        }
    }
}

/// The sentence for an adequate model. It says what would have been noticed: the departure of the
/// fundamental (of the response, where inputs have many lines) that reaches the limit of the region
/// test, at the magnitude where it shows least.
fn adequate_sentence(residuals: &Residuals, judgement: &Judgement) -> String {
    let layout = &residuals.layout;
    let least = (0..layout.magnitudes.len())
        .filter_map(|class| {
            let cells: Vec<&Cell> = layout
                .cells
                .iter()
                .filter(|cell| cell.magnitude == class)
                .filter(|cell| layout.many_lines || cell.harmonic == 1)
                .collect();
            let sizes = Sizes::of(residuals, &cells)?;
            let rows = || cells.iter().flat_map(|cell| cell.each_row());
            let dof: f64 = rows().map(|row| residuals.freedom[row]).sum();
            let excess = detectable_excess(dof, judgement.region_limit);
            let variance =
                cells.iter().map(|cell| cell.std.powi(2)).sum::<f64>() / cells.len() as f64;
            let departure = (excess * variance / cells.len() as f64).sqrt();
            let span = layout.magnitudes[class];
            (sizes.rms_simulated > 0.0).then(|| (departure / sizes.rms_simulated, span))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let unit = after_number(&layout.units.0);
    let mut sentence = "the simulation explains the measurement to within its noise".to_owned();
    if let Some((share, span)) = least.filter(|(share, _)| share.is_finite()) {
        let what = if layout.many_lines { "response" } else { "fundamental" };
        if share > 1.0 {
            return format!(
                "{sentence}; at magnitude {}{unit} the noise is as large as the {what}, so the \
                 measurement proves nothing there",
                sentence::span(span)
            );
        }
        sentence += &format!(
            "; the smallest error that the test notices on average is {} % of the {what} (rms) at \
             magnitude {}{unit}, and less at every other magnitude",
            sentence::short(100.0 * share),
            sentence::span(span)
        );
    }
    sentence
}

/// Excess χ² at which `dof` residuals reach the normal score `limit`, by bisection.
fn detectable_excess(dof: f64, limit: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e9);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if Regions::score_of(dof.max(1.0), middle) < limit { low = middle } else { high = middle }
    }
    high
}

/// Sentences on what the residuals cannot tell.
pub(crate) fn limitations(fit: &ModelFit, discrepancy: &Discrepancy) -> Vec<String> {
    let mut sentences = Vec::new();
    if fit.identification.noise == NoiseSource::Estimated && fit.contradicts_noise.is_none() {
        sentences.push(
            "the size of the noise is unknown: only structure in the residual can show that the \
             simulation is wrong; give std, repeats or the option noise_std"
                .into(),
        );
    }
    if discrepancy.noise_like && fit.identification.fit.adequate == Some(false) {
        sentences.push(format!(
            "χ² alone is borderline (p = {}); with this many tests such a value occurs by chance \
             often enough, so the model is accepted",
            sentence::short(fit.identification.fit.p_value.unwrap_or(0.0))
        ));
    }
    if fit.comparison.experiments.iter().any(|experiment| experiment.run.is_none()) {
        sentences.push(
            "the order of acquisition is not given: a drift cannot be seen; add the column `run`"
                .into(),
        );
    }
    sentences
}
