//! Rounds of mending a measurement and diagnosing it again, until no fault is found that is not known.

use crate::answers::{AsMeasured, Diagnosis, FaultKind, MeasurementFault};
use crate::diagnose::doubt::{Data, Halt, Suspicion};
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::progress::{Part, Quiet};
use crate::diagnose::selection::weighting_choice;
use crate::identify::IdentifyRequest;
use crate::measurement::Measurement;
use crate::observer::Observer as _;

use super::fault::{self, are_too_many, is_certain};
use super::mending::Mended;
use super::reached::Reached;
use super::standing::{changes_all_alike, is_clearly_better, is_explained, stands_alone};
use super::unmended::{as_answered, base_alone};
use super::{clipping, isolated, mending, readings, renumber, retest, row_regions, skew, words};

/// Most rounds of mending the measurement and diagnosing it again.
const MOST_ROUNDS: usize = 5;

/// Diagnoses a measurement, and looks for faults of it that show beside a model.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let rounds = Rounds {
        measurement,
        request,
        part,
        faults: Vec::new(),
        as_measured: None,
        unexplained: None,
        not_enough: None,
        restored: false,
        without_regions: false,
    };
    rounds.run()
}

/// What follows from the answer to a mended measurement.
enum Next {
    /// It is the answer.
    Answer(Box<Diagnosis>),
    /// The measurement is mended in another way, and diagnosed again.
    Again,
    /// The faults do not explain the measurement.
    InVain,
}

/// What is known after some rounds.
struct Rounds<'a> {
    measurement: &'a Measurement,
    request: &'a IdentifyRequest,
    part: &'a Part<'a>,
    /// The faults found so far; indices are those of the measurement as it is.
    faults: Vec<MeasurementFault>,
    /// What is known of the answer without them.
    as_measured: Option<AsMeasured>,
    /// The answer to the measurement as it is, if that was completed: nothing explains it.
    unexplained: Option<Diagnosis>,
    /// The answer with the faults, if it leaves more than noise.
    not_enough: Option<Diagnosis>,
    /// Whether rows that belong were taken back.
    restored: bool,
    /// Whether rows were taken back because they form regions.
    without_regions: bool,
}

impl Rounds<'_> {
    fn run(mut self) -> Result<Diagnosis, DiagnoseError> {
        let reached = Reached::of(self.part);
        for round in 0..=MOST_ROUNDS {
            let Ok(mended) = mending::mended(self.measurement, &self.faults) else { break };
            let (measurement, doubted) = (&mended.measurement, round < MOST_ROUNDS);
            let data = Data { measurement, doubted, lead_s: skew::lead_s(&self.faults) };
            let next = match weighting_choice::diagnose(data, self.request, reached.rest()) {
                Ok(answer) if self.faults.is_empty() => self.without_a_fault(answer),
                Ok(answer) => self.with_faults(answer),
                // The measurement as it is may still be diagnosed.
                Err(Halt::Error(_)) if !self.faults.is_empty() && !self.part.cancelled() => {
                    Next::InVain
                }
                Err(Halt::Error(error)) => return Err(error),
                Err(Halt::Faults(suspicion)) => {
                    self.add(*suspicion, &mended);
                    Next::Again
                }
            };
            match next {
                Next::Answer(answer) => return Ok(*answer),
                Next::Again => {}
                Next::InVain => break,
            }
        }
        self.in_vain(&reached)
    }

    /// Adds faults that were found beside a model of the mended measurement.
    fn add(&mut self, suspicion: Suspicion, mended: &Mended) {
        self.as_measured.get_or_insert(suspicion.as_measured);
        for mut new in suspicion.faults {
            renumber(&mut new, &mended.experiments);
            fault::add(&mut self.faults, new);
        }
    }

    /// No fault was found beside any model. If nothing explains the measurement, other readings, clipping and
    /// rows that stand out are tried.
    fn without_a_fault(&mut self, answer: Diagnosis) -> Next {
        if is_explained(&answer) {
            return Next::Answer(Box::new(answer));
        }
        let Self { measurement, request, part, .. } = *self;
        let quiet = Quiet(part);
        let alone = |measurement: &Measurement, request: &IdentifyRequest| {
            undoubted(measurement, request, Part::of(&quiet)).ok()
        };
        let read = readings::explained(&answer, measurement, request, &quiet, &alone);
        self.faults = match read {
            Some(read) => vec![read],
            None => clipping::faults(measurement.experiments()),
        };
        if self.faults.is_empty() {
            let order = retest::order(&answer);
            self.faults.extend(skew::beside_the_base_model(measurement, order, request, &quiet));
        }
        if self.faults.is_empty() {
            self.faults.extend(isolated::rows(&answer, measurement));
        }
        if self.faults.is_empty() {
            return Next::Answer(Box::new(answer));
        }
        self.as_measured = Some(as_answered(&answer));
        self.unexplained = Some(answer);
        Next::Again
    }

    /// Nothing more was found in the mended measurement. The answer stands if it leaves only noise, and every
    /// fault is needed with its causes.
    fn with_faults(&mut self, answer: Diagnosis) -> Next {
        if !is_explained(&answer) && !self.faults.iter().all(stands_alone) {
            self.not_enough = Some(answer);
            return Next::InVain;
        }
        let Self { measurement, request, part, .. } = *self;
        let belonging = || isolated::belonging(&answer, measurement, &self.faults);
        if !self.restored
            && let Some(fewer) = belonging()
        {
            self.restored = !fewer.is_empty();
            return self.once_more_with(fewer);
        }
        let needed = retest::needed(&self.faults, measurement, &answer, request, &Quiet(part));
        if let Some(fewer) = needed {
            return self.once_more_with(fewer);
        }
        if are_too_many(&self.faults, !answer.causes.is_empty()) {
            return Next::InVain;
        }
        if row_regions::form_regions(&answer, measurement, &self.faults) {
            // The model lacks something there. Other faults may be right, once.
            self.faults.retain(|fault| fault.fault != FaultKind::BadRows || is_certain(fault));
            if self.without_regions || self.faults.is_empty() {
                return Next::InVain;
            }
            self.without_regions = true;
            return Next::Again;
        }
        let alone = || base_alone(measurement, retest::order(&answer), request, part);
        let as_measured = self.as_measured.take().or_else(alone);
        let mut faults = std::mem::take(&mut self.faults);
        words::describe(&mut faults, measurement);
        Next::Answer(Box::new(Diagnosis { measurement: faults, as_measured, ..answer }))
    }

    /// The next round has only these faults; without any there is none.
    fn once_more_with(&mut self, fewer: Vec<MeasurementFault>) -> Next {
        if fewer.is_empty() {
            return Next::InVain;
        }
        self.faults = fewer;
        Next::Again
    }

    /// The answer where the faults do not explain the measurement: that with them if it is clearly better
    /// all the same, else that to the measurement as it is.
    fn in_vain(self, reached: &Reached<'_>) -> Result<Diagnosis, DiagnoseError> {
        let Self { measurement, request, mut faults, as_measured, unexplained, not_enough, .. } =
            self;
        let as_it_is = || undoubted(measurement, request, reached.rest());
        let whole = unexplained.map_or_else(as_it_is, Ok)?;
        match not_enough {
            Some(answer)
                if faults.iter().all(changes_all_alike) && is_clearly_better(&answer, &whole) =>
            {
                words::describe(&mut faults, measurement);
                let as_measured = as_measured.or_else(|| Some(as_answered(&whole)));
                Ok(Diagnosis { measurement: faults, as_measured, ..answer })
            }
            not_enough => {
                let known = not_enough.map(|answer| (faults, answer));
                without_isolated_rows(whole, known, measurement, request, reached.rest())
            }
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
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn undoubted(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let data = Data { measurement, doubted: false, lead_s: 0.0 };
    match weighting_choice::diagnose(data, request, part) {
        Ok(answer) => Ok(answer),
        Err(Halt::Error(error)) => Err(error),
        Err(Halt::Faults(_)) => unreachable!("no fault is looked for"),
    }
}
