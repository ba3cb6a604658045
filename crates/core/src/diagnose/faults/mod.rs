//! Faults of the measurement, as rivals of effects of the machine.
//!
//! A wrong row, a level with another gain, or a conjugated response makes a healthy axis look
//! wrong. Each such fault changes the data in a known way ([`candidates`]), so that it can be
//! estimated together with a model. A fault is found if it explains more than chance does
//! ([`family`]) and if a model with it has more evidence than every model without any fault, and
//! leaves only noise ([`suspects`]). The measurement is then mended ([`mending`]) and diagnosed
//! again.
//!
//! [`readings`] tries other ways to read the whole file, [`repeats`] compares repeats with each
//! other, [`one_level_out`] fits without one magnitude, which [`wrong_gain`] does before anything else
//! where a table is far from its noise, [`of_records`] tries the faults of records, and
//! [`isolated`] finds rows that stand out where nothing explains the measurement. Before faults are
//! accepted, [`retest`] asks whether they are still needed beside the effects that are named in the
//! end, and [`row_regions`] whether rows that were left out form regions, as what a model lacks does.
//! Rows and levels are looked for in tables only. [`bad_samples`] and [`clipping`] take what was found
//! as records were read, [`one_run`] another gain or delay of one of them.

mod bad_samples;
mod beside;
mod candidates;
mod clipping;
mod course;
mod family;
mod fault;
mod isolated;
mod mending;
mod noise_size;
pub(super) mod of_records;
mod one_level_out;
mod one_run;
mod power;
mod projection;
mod reached;
pub(super) mod readings;
mod repeats;
mod retest;
mod row_regions;
mod scan;
mod skew;
pub(super) mod suspects;
#[cfg(test)]
mod tests;
mod unmended;
pub(super) mod words;
pub(super) mod wrong_gain;

use crate::answers::{Diagnosis, FaultKind, Fit, MeasurementFault, Verdict};
use crate::identify::IdentifyRequest;
use crate::measurement::Measurement;

use super::doubt::{Data, Halt};
use super::error::DiagnoseError;
use super::progress::{Part, Quiet};
use super::selection::weighting_choice;
use fault::{are_too_many, is_certain};
use reached::Reached;
use suspects::CLEARLY_BETTER;
use unmended::{as_answered, base_alone};

pub use mending::as_understood;

/// Most rounds of mending the measurement and diagnosing it again.
const MOST_ROUNDS: usize = 5;

/// Diagnoses a measurement, and looks for faults of it unless the request keeps all of it. Faults that show
/// without a model are mended first, whatever explains the rest.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    if request.options.keep_all {
        return undoubted(measurement, request, part);
    }
    let shown = repeats::odd_rows(measurement).into_iter().chain(bad_samples::fault(measurement));
    let mut faults: Vec<MeasurementFault> = shown.collect();
    if faults.is_empty() {
        return searched(measurement, request, &part);
    }
    let Ok(mended) = mending::mended(measurement, &faults) else {
        return searched(measurement, request, &part);
    };
    let answer = searched(&mended.measurement, request, &part)?;
    // What is known without the other faults is known of the mended measurement only.
    let as_measured = base_alone(measurement, retest::order(&answer), request, &part);
    for mut found in answer.measurement {
        renumber(&mut found, &mended.experiments);
        fault::add(&mut faults, found);
    }
    words::describe(&mut faults, measurement);
    Ok(Diagnosis { measurement: faults, as_measured, ..answer })
}

/// Diagnoses a measurement, and looks for faults of it that show beside a model.
fn searched(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let reached = Reached::of(part);
    let as_it_is = || undoubted(measurement, request, reached.rest());
    let mut faults = Vec::<MeasurementFault>::new();
    let mut as_measured = None;
    let (mut unexplained, mut mended_only) = (None, None);
    let (mut restored, mut without_regions) = (false, false);
    for round in 0..=MOST_ROUNDS {
        let Ok(mended) = mending::mended(measurement, &faults) else { break };
        let data = Data { measurement: &mended.measurement, doubted: round < MOST_ROUNDS };
        match weighting_choice::diagnose(data, request, reached.rest()) {
            Ok(answer) if faults.is_empty() => {
                let quiet = Quiet(part);
                let alone = |measurement: &Measurement, request: &IdentifyRequest| {
                    undoubted(measurement, request, Part::of(&quiet)).ok()
                };
                if is_explained(&answer) {
                    return Ok(answer);
                }
                let read = readings::explained(&answer, measurement, request, &quiet, &alone);
                let clipped = || clipping::faults(measurement.experiments());
                let isolated = || isolated::rows(&answer, measurement).into_iter().collect();
                faults = match read {
                    Some(read) => vec![read],
                    None => {
                        Some(clipped()).filter(|found| !found.is_empty()).unwrap_or_else(isolated)
                    }
                };
                if faults.is_empty() {
                    return Ok(answer);
                }
                as_measured = Some(as_answered(&answer));
                unexplained = Some(answer);
            }
            Ok(answer) if is_explained(&answer) || faults.iter().all(stands_alone) => {
                if !restored && let Some(fewer) = isolated::belonging(&answer, measurement, &faults)
                {
                    if fewer.is_empty() {
                        break;
                    }
                    restored = true;
                    faults = fewer;
                    continue;
                }
                if let Some(fewer) =
                    retest::needed(&faults, measurement, &answer, request, &Quiet(part))
                {
                    if fewer.is_empty() {
                        break;
                    }
                    faults = fewer;
                    continue;
                }
                if are_too_many(&faults, !answer.causes.is_empty()) {
                    break;
                }
                if row_regions::form_regions(&answer, measurement, &faults) {
                    // The model lacks something there. Other faults may be right, once.
                    faults.retain(|fault| fault.fault != FaultKind::BadRows || is_certain(fault));
                    if without_regions || faults.is_empty() {
                        break;
                    }
                    without_regions = true;
                    continue;
                }
                let as_measured = match as_measured {
                    Some(known) => Some(known),
                    None => base_alone(measurement, retest::order(&answer), request, part),
                };
                words::describe(&mut faults, measurement);
                return Ok(Diagnosis { measurement: faults, as_measured, ..answer });
            }
            Ok(answer) => {
                mended_only = Some(answer);
                break;
            }
            Err(Halt::Error(error)) => return Err(error),
            Err(Halt::Faults(suspicion)) => {
                as_measured.get_or_insert(suspicion.as_measured);
                for mut new in suspicion.faults {
                    renumber(&mut new, &mended.experiments);
                    fault::add(&mut faults, new);
                }
            }
        }
    }
    let whole = unexplained.map_or_else(as_it_is, Ok)?;
    match mended_only {
        Some(answer)
            if faults.iter().all(changes_all_alike) && is_clearly_better(&answer, &whole) =>
        {
            words::describe(&mut faults, measurement);
            let as_measured = as_measured.or_else(|| Some(as_answered(&whole)));
            Ok(Diagnosis { measurement: faults, as_measured, ..answer })
        }
        mended_only => {
            let known = mended_only.map(|answer| (faults, answer));
            without_isolated_rows(whole, known, measurement, request, reached.rest())
        }
    }
}

/// The answer without the rows that stand out from their neighbours and all others, where nothing explains
/// the measurement with them and they are no region; else the answer as it is. Something else may be wrong,
/// too, but what a model lacks changes neighbours alike. Of some faults the answer may be known.
fn without_isolated_rows(
    whole: Diagnosis,
    known: Option<(Vec<MeasurementFault>, Diagnosis)>,
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let rows = (!is_explained(&whole)).then(|| isolated::outliers(&whole, measurement)).flatten();
    let Some(rows) = rows else { return Ok(whole) };
    let mut faults = vec![rows];
    let Ok(mended) = mending::mended(measurement, &faults) else { return Ok(whole) };
    let answer = match known {
        Some((known, answer)) if known == faults => answer,
        _ => undoubted(&mended.measurement, request, part)?,
    };
    let belong = isolated::belonging(&answer, measurement, &faults).is_some();
    if belong || row_regions::form_regions(&answer, measurement, &faults) {
        return Ok(whole);
    }
    words::describe(&mut faults, measurement);
    let as_measured = Some(as_answered(&whole));
    Ok(Diagnosis { measurement: faults, as_measured, ..answer })
}

/// The answer to a measurement as it is.
fn undoubted(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let data = Data { measurement, doubted: false };
    match weighting_choice::diagnose(data, request, part) {
        Ok(answer) => Ok(answer),
        Err(Halt::Error(error)) => Err(error),
        Err(Halt::Faults(_)) => unreachable!("no fault is looked for"),
    }
}

/// Whether a fault stands even where no model beside it leaves only noise.
fn stands_alone(fault: &MeasurementFault) -> bool {
    is_certain(fault) || matches!(fault.fault, FaultKind::HeldInput | FaultKind::StraightInput)
}

/// Whether a fault changes all that was measured together by one number, and leaves nothing out.
fn changes_all_alike(fault: &MeasurementFault) -> bool {
    fault.left_out.is_empty() && fault.fault != FaultKind::StdFactor
}

/// Whether an answer to the mended measurement, which leaves more than noise, is still clearly better
/// than that to the measurement as it is.
fn is_clearly_better(mended: &Diagnosis, whole: &Diagnosis) -> bool {
    let best = |answer: &Diagnosis| answer.extended.as_ref().unwrap_or(&answer.base).fit.clone();
    let (mended, whole) = (best(mended), best(whole));
    let left = |fit: &Fit| fit.nrmse.powi(2);
    let (ours, theirs) = match mended.chi2.zip(whole.chi2) {
        Some(both) => both,
        // Weights differ where the noise is not used.
        None => (left(&mended), left(&whole)),
    };
    let dof = mended.dof.max(1) as f64;
    suspects::misfit(theirs, dof, false) - suspects::misfit(ours, dof, false) > CLEARLY_BETTER
}

/// Whether the answer's best model leaves only noise, and convinces.
fn is_explained(answer: &Diagnosis) -> bool {
    matches!(answer.verdict, Verdict::Adequate | Verdict::Explained)
}

/// Replaces indices of experiments of a mended measurement by those before it was mended.
fn renumber(fault: &mut MeasurementFault, experiments: &[usize]) {
    let before = |index: &mut usize| *index = experiments.get(*index).copied().unwrap_or(*index);
    fault.experiment.iter_mut().for_each(before);
    fault.left_out.iter_mut().for_each(|row| before(&mut row.experiment));
}
