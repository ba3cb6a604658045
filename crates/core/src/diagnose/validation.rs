//! External validation: a stored answer is tested on another measurement.
//!
//! Nothing is fitted. Both models, base and extended, are rebuilt from their reported parameters,
//! simulated with the inputs of the other measurement, and compared with its response as measured.

pub(super) mod motions;
mod remarks;

use crate::answers::{
    Answer, Cause, ComparedExperiment, Comparison, Diagnosis, Gain, Identification, ValidatedCause,
    ValidatedModel, ValidatedModels, ValidatedMotion, Validation, ValidationProvenance, Verdict,
    Weighting,
};
use crate::identify::{self, IdentifyError, IdentifyRequest, UnitCompatibility};
use crate::measurement::Measurement;
use crate::observer::{Observer, Steady};

use super::diagnose_part;
use super::error::{DiagnoseError, ValidateError};
use super::holdout::gain::{gain, summary};
use super::holdout::heldout_predictions::{Predicted, groups, predicted};
use super::progress::Part;
use remarks::Tried;

/// Shares of the progress of [`diagnose_validated`].
const DIAGNOSIS_SPAN: [f64; 2] = [0.0, 0.98];
const VALIDATION_SPAN: [f64; 2] = [0.98, 1.0];

/// Tests the models of an answer on another measurement.
///
/// Experiments in which one of the models has no response count for neither.
///
/// # Errors
/// See [`ValidateError`].
pub fn validate(
    answer: &Answer,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Validation, ValidateError> {
    let agreement = UnitCompatibility::with_answer(answer.base(), measurement);
    let agreement = without_contradiction(agreement)?;
    if !measurement.transients().is_empty() {
        let outcome = motions::tried(answer, measurement, observer)?;
        return Ok(concluded(answer, measurement, &agreement, outcome));
    }
    let base = simulated(answer.base(), measurement, observer)?;
    let extended = answer.extended().map(|model| simulated(model, measurement, observer));
    compared(answer, measurement, &agreement, &base, extended.transpose()?.as_ref())
}

/// Results of the models of an answer on other data.
pub(super) struct Outcome {
    pub response_quantity: String,
    pub response_unit: String,
    pub models: ValidatedModels,
    pub gain: Option<Gain>,
    pub noise_known: bool,
    pub motions: Vec<ValidatedMotion>,
    /// Remarks on how the models were compared with the data.
    pub remarks: Vec<String>,
}

/// The validation from the comparisons of both models with a periodic measurement.
fn compared(
    answer: &Answer,
    measurement: &Measurement,
    agreement: &UnitCompatibility,
    base: &Comparison,
    extended: Option<&Comparison>,
) -> Result<Validation, ValidateError> {
    let mut kept = predicted(base);
    let mut after = extended.map(predicted);
    if let Some(after) = &mut after {
        kept.retain(|row, _| after.contains_key(row));
        after.retain(|row, _| kept.contains_key(row));
    }
    if kept.is_empty() {
        let reason = "they have no response to any of its experiments".into();
        return Err(ValidateError::Unusable { reason });
    }
    let experiments: Vec<&ComparedExperiment> = base
        .experiments
        .iter()
        .filter(|e| kept.range((e.experiment, 0)..=(e.experiment, usize::MAX)).next().is_some())
        .collect();
    let groups = groups(&experiments);
    let noise_known = !base.std_estimated;
    let gain = after.as_ref().and_then(|after| {
        gain(&kept, after, &groups, noise_known, remarks::heldout(base, &experiments))
    });
    let model = |predicted: &Predicted, comparison: &Comparison| ValidatedModel {
        unanswered: comparison.unanswered.clone(),
        ..summary(predicted, noise_known)
    };
    let outcome = Outcome {
        response_quantity: base.response_quantity.clone(),
        response_unit: base.response_unit.clone(),
        models: ValidatedModels {
            base: model(&kept, base),
            extended: after.as_ref().zip(extended).map(|(p, c)| model(p, c)),
        },
        gain,
        noise_known,
        motions: Vec::new(),
        remarks: Vec::new(),
    };
    Ok(concluded(answer, measurement, agreement, outcome))
}

/// The validation from an outcome; the verdict is lowered if the causes hurt.
fn concluded(
    answer: &Answer,
    measurement: &Measurement,
    agreement: &UnitCompatibility,
    outcome: Outcome,
) -> Validation {
    let Outcome { models, gain, noise_known, .. } = outcome;
    let verdict = answer.verdict().map(|verdict| {
        // The verdict of a diagnosis that was validated on these data is lowered already.
        let validated = match answer {
            Answer::Diagnosis(diagnosis) => diagnosis.validation.as_ref(),
            Answer::Identification(_) => None,
        };
        let taken = validated.is_some_and(|v| v.data_sha256 == measurement.sha256());
        let lower = !taken && gain.as_ref().is_some_and(hurts);
        if lower { lowered(verdict) } else { verdict }
    });
    let tried = Tried {
        causes: answer.causes(),
        models: &models,
        gain: gain.as_ref(),
        verdicts: answer.verdict().zip(verdict),
        noise_known,
    };
    let mut said = tried.remarks();
    said.extend(outcome.remarks);
    said.extend(remarks::of_data(answer, measurement, agreement));
    Validation {
        data_sha256: measurement.sha256().to_owned(),
        response_quantity: outcome.response_quantity,
        response_unit: outcome.response_unit,
        motions: outcome.motions,
        causes: causes(answer.causes(), gain.as_ref()),
        models,
        gain,
        verdict,
        remarks: said,
        provenance: provenance(answer.base(), measurement),
    }
}

/// Runs [`super::diagnose`] and measures the gain on a second measurement. If the causes hurt there, the
/// verdict is one step lower.
///
/// # Errors
/// See [`DiagnoseError`]. A second measurement with the same data or contradicting units is refused
/// before anything is computed.
pub fn diagnose_validated(
    measurement: &Measurement,
    second: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    without_contradiction(UnitCompatibility::between(measurement, second))?;
    if !second.sha256().is_empty() && second.sha256() == measurement.sha256() {
        return Err(ValidateError::SameData.into());
    }
    let steady = Steady::new(observer);
    let whole = Part::of(&steady);
    // The comparison afterwards takes next to no time.
    let diagnosis = Part { last: true, ..whole.part(DIAGNOSIS_SPAN) };
    let answer = diagnose_part(measurement, request, diagnosis)?;
    let stage = whole.part(VALIDATION_SPAN).stage("comparing with the second measurement", 1);
    let answer = validated(answer, second, observer)?;
    stage.step();
    Ok(answer)
}

/// A diagnosis with the results of its validation on a second measurement.
fn validated(
    diagnosis: Diagnosis,
    second: &Measurement,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let answer = Answer::Diagnosis(Box::new(diagnosis));
    let validation = validate(&answer, second, observer);
    let Answer::Diagnosis(answer) = answer else { unreachable!("it is a diagnosis") };
    let mut answer = *answer;
    match validation {
        Ok(validation) => {
            if let Some(gain) = &validation.gain {
                if hurts(gain) {
                    answer.limitations.extend(validation.remarks.first().cloned());
                }
                answer.gain = Some(gain.clone());
            }
            for (cause, here) in answer.causes.iter_mut().zip(&validation.causes) {
                cause.gain = here.gain.clone().or(cause.gain.take());
            }
            answer.verdict = validation.verdict.unwrap_or(answer.verdict);
            answer.validation = Some(validation);
        }
        Err(ValidateError::Cancelled) => return Err(IdentifyError::Cancelled.into()),
        // The results from the first measurement remain valid.
        Err(error) => answer.limitations.push(format!("the second measurement is unused: {error}")),
    }
    Ok(answer)
}

fn without_contradiction(agreement: UnitCompatibility) -> Result<UnitCompatibility, ValidateError> {
    match agreement {
        UnitCompatibility::Different { quantity, fitted, here } => {
            Err(ValidateError::Units { quantity, fitted, here })
        }
        agreement => Ok(agreement),
    }
}

/// Compares a model with the measurement, by the noise that this measurement states. The option
/// `noise_std` is of the fitted data and in the units of their response, and how those were
/// weighted says nothing of how well a model predicts.
fn simulated(
    model: &Identification,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Comparison, ValidateError> {
    if observer.cancelled() {
        return Err(ValidateError::Cancelled);
    }
    let mut model = model.clone();
    model.provenance.options.noise_std = None;
    model.provenance.options.weights = Weighting::Noise;
    Ok(identify::compare(measurement, &model)?)
}

/// The gain of each cause alone, known only if there is a single one: that of the extended model.
fn causes(causes: &[Cause], gain: Option<&Gain>) -> Vec<ValidatedCause> {
    let alone = gain.filter(|_| causes.len() == 1);
    let cause =
        |cause: &Cause| ValidatedCause { effect: cause.effect.clone(), gain: alone.cloned() };
    causes.iter().map(cause).collect()
}

/// Whether the extended model certainly predicts worse.
pub(super) fn hurts(gain: &Gain) -> bool {
    gain.interval95[1] < 1.0
}

fn lowered(verdict: Verdict) -> Verdict {
    match verdict {
        Verdict::Explained => Verdict::Improved,
        Verdict::Improved | Verdict::Unexplained => Verdict::Unexplained,
        Verdict::Adequate => Verdict::Adequate,
    }
}

fn provenance(fitted: &Identification, measurement: &Measurement) -> ValidationProvenance {
    ValidationProvenance {
        software_version: env!("CARGO_PKG_VERSION").to_owned(),
        fitted_data_sha256: fitted.provenance.data_sha256.clone(),
        validation_data_sha256: measurement.sha256().to_owned(),
        fitted_by_version: fitted.provenance.software_version.clone(),
        options: fitted.provenance.options,
    }
}

#[cfg(test)]
mod tests;
