//! Validation of an answer on motions that do not repeat.
//!
//! Both models simulate every motion. The initial state is given, or each model estimates it from a
//! first stretch that is not compared (`identify::follow`). The residuals are summed over
//! consecutive blocks of time, long enough to be nearly independent. The interval of the gain
//! covers only what happened in the motion: if a few moments decide, as on an axis that seldom
//! sticks, a motion without one gives too small a gain and too short an interval.

use crate::answers::{
    Answer, BeginningValue, Identification, Unanswered, ValidatedModel, ValidatedModels,
    ValidatedMotion,
};
use crate::identify;
use crate::identify::{Begun, Followed, IdentifyError};
use crate::measurement::{Measurement, ResponseKind, after_number};
use crate::observer::Observer;

use super::Outcome;
use super::remarks;
use crate::diagnose::error::ValidateError;
use crate::diagnose::holdout::gain::{ResidualSums, Sample, gain_of_groups, summary_of};

/// Largest number of blocks in all motions together: beyond, Student's t hardly gets smaller.
const MOST_BLOCKS: f64 = 24.0;

/// Shortest duration of a block, in time constants of the mechanics. Tuned.
const BLOCK_TIME_CONSTANTS: f64 = 8.0;

/// The simulation of every motion with one model.
type Simulations = Vec<Result<Followed, Unanswered>>;

/// Tests the models of an answer on the motions of a measurement.
pub(crate) fn tried(
    answer: &Answer,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Outcome, ValidateError> {
    let transients = measurement.transients().iter();
    let unscored_s: Result<Vec<f64>, IdentifyError> =
        transients.map(|transient| identify::unscored_s(transient, answer.base())).collect();
    let unscored_s = unscored_s?;
    let follow = |model: &Identification| {
        if observer.cancelled() {
            return Err(ValidateError::Cancelled);
        }
        Ok(identify::follow(measurement, model, &unscored_s)?)
    };
    let base = follow(answer.base())?;
    let extended = answer.extended().map(follow).transpose()?;
    let both = |i: usize| {
        base[i].is_ok()
            && extended.as_ref().is_none_or(|extended: &Simulations| extended[i].is_ok())
    };
    let kept: Vec<usize> = (0..base.len()).filter(|i| both(*i)).collect();
    if kept.is_empty() {
        let reasons = base.iter().chain(extended.iter().flatten());
        let mut why =
            reasons.filter_map(|tried| tried.as_ref().err()).map(|lost| lost.reason.clone());
        let reason =
            format!("they can follow none of its motions: {}", why.next_back().unwrap_or_default());
        return Err(ValidateError::Unusable { reason });
    }
    let block_s = block_s(answer.base(), measurement, &kept, &unscored_s);
    let blocks = [Some(&base), extended.as_ref()].map(|model| {
        let model = model?;
        let followed = kept.iter().filter_map(|i| Some((*i, model[*i].as_ref().ok()?)));
        let blocks = followed.map(|(i, followed)| {
            let step_s = measurement.transients()[i].step_s;
            in_blocks(followed, ((block_s / step_s).round() as usize).max(1))
        });
        Some(blocks.flatten().collect::<Vec<ResidualSums>>())
    });
    let [Some(before), after] = blocks else { unreachable!("the base model is tried") };
    let heldout = heldout(measurement, &kept, &unscored_s, before.len(), block_s);
    let pairs = |after: &Vec<ResidualSums>| -> Vec<[ResidualSums; 2]> {
        before.iter().zip(after).map(|(before, after)| [*before, *after]).collect()
    };
    let gain = after
        .as_ref()
        .and_then(|after| gain_of_groups(&pairs(after), Sample::Independent, false, heldout));
    let components = kept.iter().filter_map(|i| base[*i].as_ref().ok()).map(|f| f.measured.len());
    let components: usize = components.sum();
    let model = |blocks: &[ResidualSums], tries: &Simulations| ValidatedModel {
        unanswered: tries.iter().filter_map(|tried| tried.as_ref().err().cloned()).collect(),
        ..summary_of(&ResidualSums::sum(blocks), components, false)
    };
    let motions = motions(measurement, &unscored_s, &base, extended.as_ref());
    let metadata = measurement.metadata();
    Ok(Outcome {
        response_quantity: match metadata.response_kind {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        }
        .into(),
        response_unit: metadata.response.unit.clone(),
        models: ValidatedModels {
            base: model(&before, &base),
            extended: after.as_ref().zip(extended.as_ref()).map(|(left, tries)| model(left, tries)),
        },
        gain,
        noise_known: false,
        remarks: remarks::of_motions(&motions, metadata, extended.is_some()),
        motions,
    })
}

/// Duration of a block in seconds.
fn block_s(
    base: &Identification,
    measurement: &Measurement,
    kept: &[usize],
    unscored_s: &[f64],
) -> f64 {
    let compared_s = |i: &usize| measurement.transients()[*i].duration_s() - unscored_s[*i];
    let whole_s: f64 = kept.iter().map(compared_s).sum();
    let rate = base.parameters.get("pole").and_then(|pole| pole.value).map_or(0.0, |pole| -pole);
    let forgets_s = if rate > 0.0 { BLOCK_TIME_CONSTANTS / rate } else { 0.0 };
    // An interval needs two blocks, even if they are too short to be independent.
    (whole_s / MOST_BLOCKS).max(forgets_s).min(0.5 * whole_s)
}

/// Sums over consecutive blocks; a last one shorter than half is joined to the one before.
fn in_blocks(followed: &Followed, samples: usize) -> Vec<ResidualSums> {
    let count = followed.measured.len();
    let blocks = ((count as f64 / samples as f64).round() as usize).max(1);
    let mut left = vec![ResidualSums::default(); blocks];
    for (n, (measured, simulated)) in followed.measured.iter().zip(&followed.simulated).enumerate()
    {
        left[(n / samples).min(blocks - 1)].add_sample(*measured, *simulated);
    }
    left
}

fn motions(
    measurement: &Measurement,
    unscored_s: &[f64],
    base: &Simulations,
    extended: Option<&Simulations>,
) -> Vec<ValidatedMotion> {
    let values = |tried: Option<&Result<Followed, Unanswered>>| {
        let found = tried.and_then(|tried| tried.as_ref().ok()).map(|f| f.beginning.as_slice());
        let value = |begun: &Begun| BeginningValue {
            quantity: begun.quantity.name().into(),
            value: begun.value,
            implausible: begun.implausible.clone(),
        };
        found.unwrap_or_default().iter().map(value).collect()
    };
    let all = measurement.transients().iter().enumerate();
    let motion = |(i, transient): (usize, &crate::measurement::Transient)| ValidatedMotion {
        experiment: i,
        duration_s: transient.duration_s(),
        unscored_s: unscored_s[i],
        beginning_given: transient.beginning.velocity.is_some(),
        base: values(base.get(i)),
        extended: values(extended.and_then(|extended| extended.get(i))),
    };
    all.map(motion).collect()
}

/// What was held out, in words.
fn heldout(
    measurement: &Measurement,
    kept: &[usize],
    unscored_s: &[f64],
    blocks: usize,
    block_s: f64,
) -> String {
    let transients = || kept.iter().map(|i| &measurement.transients()[*i]);
    let whole_s: f64 = transients().map(|transient| transient.duration_s()).sum();
    let unscored_s: f64 = kept.iter().map(|i| unscored_s[*i]).sum();
    let magnitude = transients().map(|transient| transient.magnitude()).fold(0.0, f64::max);
    let unit = after_number(&measurement.metadata().input.unit);
    let motions = match kept.len() {
        1 => "one motion that does not repeat".to_owned(),
        count => format!("{count} motions that do not repeat"),
    };
    let without = if unscored_s > 0.0 {
        format!(" without the first {unscored_s:.4} s")
    } else {
        String::new()
    };
    format!(
        "a second measurement: {motions}, {whole_s:.4} s{without}, magnitude {magnitude:.4}{unit}, \
         in {blocks} blocks of {block_s:.4} s"
    )
}

#[cfg(test)]
mod tests;
