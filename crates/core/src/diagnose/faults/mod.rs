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
//! other. Faults of one row, level or experiment are looked for in tables only.

mod candidates;
mod family;
mod fault;
mod mending;
mod noise_size;
mod projection;
mod readings;
mod repeats;
mod scan;
pub(super) mod suspects;
#[cfg(test)]
mod tests;
mod words;

use std::sync::{Mutex, PoisonError};

use crate::answers::{AsMeasured, ConvergenceRow, Diagnosis, MeasurementFault, Progress, Verdict};
use crate::identify::{FitSession, IdentifyError, IdentifyRequest, Intervals};
use crate::measurement::Measurement;
use crate::observer::Observer;

use super::error::DiagnoseError;
use super::progress::{Part, Quiet};
use super::selection::weighting_choice;

pub use mending::as_understood;

/// Most rounds of mending the measurement and diagnosing it again.
const MOST_ROUNDS: usize = 5;

/// A measurement to be diagnosed.
#[derive(Clone, Copy)]
pub(crate) struct Data<'a> {
    /// The measurement.
    pub measurement: &'a Measurement,
    /// Whether faults of it are looked for.
    pub doubted: bool,
}

/// Faults that were found before an answer was complete.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Suspicion {
    /// The faults; indices are those of the measurement that was diagnosed.
    pub faults: Vec<MeasurementFault>,
    /// The answer without them, as far as it was known.
    pub as_measured: AsMeasured,
}

/// Why a diagnosis ended without an answer.
#[derive(Debug)]
pub(crate) enum Halt {
    /// An error.
    Error(DiagnoseError),
    /// The measurement has faults.
    Faults(Box<Suspicion>),
}

impl From<DiagnoseError> for Halt {
    fn from(error: DiagnoseError) -> Self {
        Self::Error(error)
    }
}

impl From<IdentifyError> for Halt {
    fn from(error: IdentifyError) -> Self {
        Self::Error(error.into())
    }
}

/// Diagnoses a measurement, and looks for faults of it unless the request keeps all of it.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let reached = Reached { whole: &part, fraction: Mutex::new(0.0) };
    let undoubted = || undoubted(measurement, request, reached.rest());
    if request.options.keep_all {
        return undoubted();
    }
    let mut faults: Vec<MeasurementFault> = repeats::odd_rows(measurement).into_iter().collect();
    let mut as_measured = None;
    for round in 0..=MOST_ROUNDS {
        let Ok(mended) = mending::mended(measurement, &faults) else { break };
        let data = Data { measurement: &mended.measurement, doubted: round < MOST_ROUNDS };
        match weighting_choice::diagnose(data, request, reached.rest()) {
            Ok(answer) if faults.is_empty() => {
                let quiet = Quiet(&part);
                let read =
                    |answer| readings::explained(answer, measurement, request, Part::of(&quiet));
                let Some(reading) = (!is_explained(&answer)).then(|| read(&answer)).flatten()
                else {
                    return Ok(answer);
                };
                as_measured = Some(as_answered(&answer));
                faults.push(reading);
            }
            Ok(answer) if is_explained(&answer) || faults.iter().all(is_certain) => {
                let as_measured = match as_measured {
                    Some(known) => Some(known),
                    None => base_alone(measurement, request, &part),
                };
                words::describe(&mut faults, measurement);
                return Ok(Diagnosis { measurement: faults, as_measured, ..answer });
            }
            Ok(_) => break,
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
    undoubted()
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

/// Whether a fault is found without a model of the machine, or whatever that is.
fn is_certain(fault: &MeasurementFault) -> bool {
    use crate::answers::FaultKind::{
        BadRows, Conjugated, ResponseKind, ReversedSign, SineReference,
    };
    match fault.fault {
        Conjugated | ReversedSign | SineReference | ResponseKind => true,
        BadRows => fault.left_out.iter().all(|row| row.repeat.is_some()),
        _ => false,
    }
}

/// Whether the answer's best model leaves only noise.
fn is_explained(answer: &Diagnosis) -> bool {
    let best = answer.extended.as_ref().unwrap_or(&answer.base);
    match answer.verdict {
        Verdict::Adequate | Verdict::Explained => true,
        Verdict::Improved => best.fit.adequate != Some(false),
        Verdict::Unexplained => false,
    }
}

/// A complete answer to the measurement as it is.
fn as_answered(answer: &Diagnosis) -> AsMeasured {
    AsMeasured {
        nrmse: answer.base.fit.nrmse,
        chi2_per_dof: answer.base.fit.chi2_per_dof,
        causes: answer.causes.iter().map(|cause| cause.effect.clone()).collect(),
        nrmse_with_causes: answer.extended.as_ref().map(|extended| extended.fit.nrmse),
    }
}

/// What the base model leaves of the measurement as it is.
fn base_alone(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Option<AsMeasured> {
    let quietly = Quiet(part);
    let session = FitSession::new(measurement, request, &quietly).ok()?;
    as_measured(&session)
}

/// What the base model of a session leaves.
pub(super) fn as_measured(session: &FitSession<'_>) -> Option<AsMeasured> {
    let fit = session.judge(session.base(), Intervals::Curvature).ok()?.identification.fit;
    Some(AsMeasured {
        nrmse: fit.nrmse,
        chi2_per_dof: fit.chi2_per_dof,
        causes: Vec::new(),
        nrmse_with_causes: None,
    })
}

/// Another reading of the whole file that is clearly right, if the stated one is wrong.
pub(super) fn misread(
    session: &FitSession<'_>,
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Option<Halt> {
    let reading = readings::better(session, measurement, request, &Quiet(part))?;
    let as_measured = as_measured(session)?;
    Some(Halt::Faults(Box::new(Suspicion { faults: vec![reading], as_measured })))
}

/// Replaces indices of experiments of a mended measurement by those before it was mended.
fn renumber(fault: &mut MeasurementFault, experiments: &[usize]) {
    let before = |index: &mut usize| *index = experiments.get(*index).copied().unwrap_or(*index);
    fault.experiment.iter_mut().for_each(before);
    fault.left_out.iter_mut().for_each(|row| before(&mut row.experiment));
}

/// Keeps the fraction of the progress that was reached, so that another round goes on from there.
struct Reached<'a> {
    whole: &'a Part<'a>,
    fraction: Mutex<f64>,
}

impl Reached<'_> {
    fn rest(&self) -> Part<'_> {
        let fraction = *self.fraction.lock().unwrap_or_else(PoisonError::into_inner);
        Part { whole: self, span: [fraction, 1.0], last: self.whole.last }
    }
}

impl Observer for Reached<'_> {
    fn elapsed_s(&self) -> f64 {
        self.whole.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        *self.fraction.lock().unwrap_or_else(PoisonError::into_inner) = progress.fraction;
        self.whole.progress(progress);
    }

    fn rest_is_certain(&self) {
        self.whole.rest_is_certain();
    }

    fn row(&self, row: ConvergenceRow) {
        self.whole.row(row);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}
