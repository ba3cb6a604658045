//! What must hold of every answer, whatever was measured.

use std::panic::{AssertUnwindSafe, catch_unwind};

use servoscope_core::answers::{Diagnosis, Identification, NoiseSource, Verdict};
use servoscope_core::diagnose::{DiagnoseError, as_understood, diagnose};
use servoscope_core::identify::{IdentifyError, IdentifyRequest, compare, identify};
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{Source, read};

use super::cases::Case;
use super::records::RecordCase;
use crate::machines::Watcher;

/// Questions whether to go on that a case may take: a search that does not end asks without end.
/// The three orders of the base model take some 12 000, a diagnosis of a few points up to twice
/// that; this is more than a hundred times as many.
const MOST_QUESTIONS: u64 = 3_000_000;

/// How far a case is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// The base model is fitted.
    Identify,
    /// The whole diagnosis is made, too.
    Diagnose,
}

/// What was found of a case.
#[derive(Debug, Default)]
pub struct Findings {
    /// What must not be, in sentences.
    pub faults: Vec<String>,
    /// Whether there was an answer at all.
    pub answered: bool,
}

/// Reads and identifies a case, and diagnoses it where that is asked for.
pub fn examine(case: &Case, depth: Depth) -> Findings {
    let mut findings = Findings::default();
    // What is refused is refused by line and column; that is the formats' own test.
    if let Some(measurement) = read_text(&case.text(), &mut findings) {
        examine_measurement(&measurement, depth, &mut findings);
    }
    findings
}

/// The same of a record. A stated period that is not one of the input must be refused, or said to
/// be wrong.
pub fn examine_record(case: &RecordCase, depth: Depth) -> Findings {
    let mut findings = Findings::default();
    let Some(text) = case.text() else { return findings };
    let Some(measurement) = read_text(&text, &mut findings) else { return findings };
    let said = measurement.notes().iter().any(|note| note.contains("period"));
    if !case.is_periodic() && !said {
        findings.faults.push("a stated period that is wrong is used without a word".into());
    }
    examine_measurement(&measurement, depth, &mut findings);
    findings
}

/// What was measured, unless it is refused.
fn read_text(text: &str, findings: &mut Findings) -> Option<Measurement> {
    let source = Source { name: "case.csv", bytes: text.as_bytes() };
    guarded(findings, "reading", || read(&[source]))?.ok()
}

fn examine_measurement(measurement: &Measurement, depth: Depth, findings: &mut Findings) {
    let request = IdentifyRequest::default();
    let watcher = Watcher::cancelling_after(MOST_QUESTIONS);
    let identified = guarded(findings, "identify", || identify(measurement, &request, &watcher));
    match identified {
        Some(Ok(answer)) => {
            findings.answered = true;
            check_identification(measurement, &answer, findings);
        }
        Some(Err(error)) => check_refusal("identify", &error, findings),
        None => {}
    }
    if depth == Depth::Identify {
        return;
    }
    let diagnosed = guarded(findings, "diagnose", || diagnose(measurement, &request, &watcher));
    match diagnosed {
        Some(Ok(answer)) => {
            check_diagnosis(measurement, &answer, findings);
        }
        Some(Err(DiagnoseError::Identify(error))) => {
            check_refusal("diagnose", &error, findings);
        }
        Some(Err(error)) => findings.faults.push(format!("diagnose: {error}")),
        None => {}
    }
}

fn guarded<T>(findings: &mut Findings, what: &str, compute: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(compute))
        .map_err(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("?");
            findings.faults.push(format!("{what} panicked: {text}"));
        })
        .ok()
}

fn check_refusal(what: &str, error: &IdentifyError, findings: &mut Findings) {
    match error {
        IdentifyError::Unusable { .. } => {}
        IdentifyError::Cancelled => findings.faults.push(format!("{what} does not end")),
        IdentifyError::Options(_) => findings.faults.push(format!("{what}: {error}")),
    }
}

/// Sum of squares of what a model leaves, by the noise that the measurement states, and the
/// number of real data; `None` where nothing is stated.
fn stated_misfit(measurement: &Measurement, answer: &Identification) -> Option<(f64, usize)> {
    let stated =
        measurement.experiments().iter().flat_map(|e| &e.response).all(|h| h.std.is_some());
    if !stated {
        return None;
    }
    let comparison = compare(measurement, answer).ok()?;
    let (mut sum, mut count) = (0.0, 0);
    for experiment in &comparison.experiments {
        let measured = &measurement.experiments()[experiment.experiment];
        for harmonic in &experiment.harmonics {
            let std = measured.harmonic(harmonic.order)?.std?;
            let parts = if harmonic.order == 0 { 1 } else { 2 };
            for part in 0..parts {
                sum += ((harmonic.measured[part] - harmonic.simulated[part]) / std).powi(2);
                count += 1;
            }
        }
    }
    Some((sum, count))
}

/// Whether a model leaves more of the response than it simulates, beyond rounding.
fn leaves_more_than_it_simulates(measurement: &Measurement, answer: &Identification) -> bool {
    let Ok(comparison) = compare(measurement, answer) else { return false };
    let (mut left, mut simulated) = (0.0, 0.0);
    for harmonic in comparison.experiments.iter().flat_map(|e| &e.harmonics) {
        for part in 0..2 {
            left += (harmonic.measured[part] - harmonic.simulated[part]).powi(2);
            simulated += harmonic.simulated[part].powi(2);
        }
    }
    left > 1.001 * simulated
}

fn check_identification(
    measurement: &Measurement,
    answer: &Identification,
    findings: &mut Findings,
) {
    let mut fault = |text: String| findings.faults.push(text);
    if answer.fit.dof < 0 {
        fault(format!("{} degrees of freedom", answer.fit.dof));
    }
    let identifiable = answer.parameters.values().filter(|p| p.identifiable && !p.at_bound).count();
    let data = real_numbers(measurement);
    // The DC gain follows from pole and constant.
    if answer.fit.dof == 0 && answer.noise == NoiseSource::Estimated && identifiable > 0 {
        fault(format!("{identifiable} parameters determined with no degree of freedom"));
    }
    if identifiable > data + 1 {
        fault(format!("{identifiable} parameters determined from {data} numbers"));
    }
    match serde_json::to_string(answer) {
        Ok(text) => {
            if let Err(error) = serde_json::from_str::<Identification>(&text) {
                fault(format!("the answer has what is no number: {error}"));
            }
        }
        Err(error) => fault(format!("the answer cannot be written: {error}")),
    }
    if answer.fit.adequate == Some(true) {
        if leaves_more_than_it_simulates(measurement, answer) {
            fault("adequate, and leaves more than it simulates".into());
        }
        if contradicted(measurement, answer) {
            fault("adequate against the stated noise".into());
        }
    }
}

/// Whether what a model leaves exceeds the stated noise beyond any doubt: by ten standard
/// deviations of χ².
fn contradicted(measurement: &Measurement, answer: &Identification) -> bool {
    stated_misfit(measurement, answer).is_some_and(|(chi2, count)| {
        let count = count as f64;
        chi2 > count + 10.0 * (2.0 * count).sqrt() + 10.0
    })
}

/// The measurement that the models of an answer are of: without the faults that were found in it.
/// Rows that were left out state a deviation so large that they do not count.
fn mended(measurement: &Measurement, answer: &Diagnosis) -> Measurement {
    let faults = &answer.measurement;
    let understood = as_understood(measurement, faults).expect("it is understood");
    let mut experiments = understood.experiments().to_vec();
    for row in faults.iter().flat_map(|fault| &fault.left_out).filter(|row| row.repeat.is_none()) {
        let response = &mut experiments[row.experiment].response;
        let harmonic = response.iter_mut().find(|harmonic| harmonic.order == row.harmonic);
        let harmonic = harmonic.expect("a row that is left out was measured");
        harmonic.std = harmonic.std.map(|std| 1e6 * std);
    }
    let (metadata, notes) = (understood.metadata().clone(), understood.notes().to_vec());
    Measurement::new(metadata, experiments, notes, understood.sha256().to_owned()).expect("valid")
}

fn check_diagnosis(measurement: &Measurement, answer: &Diagnosis, findings: &mut Findings) {
    let measurement = &mended(measurement, answer);
    check_identification(measurement, &answer.base, findings);
    if let Some(extended) = &answer.extended {
        check_identification(measurement, extended, findings);
    }
    let best = answer.extended.as_ref().unwrap_or(&answer.base);
    let mut fault = |text: String| findings.faults.push(text);
    match serde_json::to_string(answer) {
        Ok(text) => {
            if let Err(error) = serde_json::from_str::<Diagnosis>(&text) {
                let place = text.get(..error.column()).unwrap_or(&text);
                let start = place.char_indices().rev().nth(80).map_or(0, |(at, _)| at);
                fault(format!("the diagnosis has what is no number: {error}: {}", &place[start..]));
            }
        }
        Err(error) => fault(format!("the diagnosis cannot be written: {error}")),
    }
    if matches!(answer.verdict, Verdict::Adequate | Verdict::Explained) {
        if contradicted(measurement, best) {
            let faults = answer.measurement.iter().map(|fault| &fault.sentence);
            let faults = faults.collect::<Vec<_>>();
            fault(format!("{:?} against the stated noise: {faults:?}", answer.verdict));
        }
        if leaves_more_than_it_simulates(measurement, best) {
            let faults = answer.measurement.iter().map(|fault| &fault.sentence);
            let faults = faults.collect::<Vec<_>>();
            fault(format!("{:?}, and leaves more than it simulates: {faults:?}", answer.verdict));
        }
    }
    if best.fit.dof == 0 && answer.verdict != Verdict::Adequate {
        fault(format!("{:?} with no degree of freedom", answer.verdict));
    }
    let data = real_numbers(measurement);
    let known = usize::from(best.noise == NoiseSource::Estimated);
    let free = best.parameters.len().saturating_sub(1);
    if !answer.causes.is_empty() && data < free + known {
        fault(format!("{:?} named from {data} data", answer.causes[0].effect));
    }
}

/// How many real numbers were measured.
fn real_numbers(measurement: &Measurement) -> usize {
    let all = measurement.experiments().iter().flat_map(|e| &e.response);
    all.map(|h| if h.order == 0 { 1 } else { 2 }).sum()
}
