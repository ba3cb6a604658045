//! Whether faults are still needed beside the effects that are named in the end.
//!
//! A fault is found beside one effect at most. Where a second one is found in the mended measurement,
//! it may explain what was taken for a fault. And in a wrong local minimum a right effect may leave rows
//! unexplained. So the final model is fitted to the measurement with the faults, from several starts:
//! if it leaves only noise there, and they would explain no more of that than chance does, they are none.

use crate::answers::{Diagnosis, FaultKind, MeasurementFault, PlantRequest};
use crate::effects;
use crate::identify::{FitAccuracy, FitSession, IdentifyRequest, Intervals, Model};
use crate::measurement::Measurement;
use crate::observer::Observer;

use crate::diagnose::progress::Part;
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::search::fitter::Fitter;
use crate::diagnose::selection::evidence::NoiseScale;

use super::family::Family;
use super::fault::{self, is_certain};
use super::mending;
use super::scan::Scan;

/// The faults that are needed beside the effects of an answer, which may explain all others or one of
/// them; `None` if all are. The size of the noise no effect explains.
pub(super) fn needed(
    faults: &[MeasurementFault],
    measurement: &Measurement,
    answer: &Diagnosis,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<Vec<MeasurementFault>> {
    let is_asked =
        |fault: &MeasurementFault| !is_certain(fault) && fault.fault != FaultKind::StdFactor;
    let asked: Vec<usize> = (0..faults.len()).filter(|i| is_asked(&faults[*i])).collect();
    let each = asked.iter().filter(|_| asked.len() > 1).map(|i| vec![*i]);
    let mut groups = std::iter::once(asked.clone()).filter(|all| !all.is_empty()).chain(each);
    let kept = |group: &[usize]| -> Vec<MeasurementFault> {
        let indices = (0..faults.len()).filter(|i| !group.contains(i));
        indices.map(|i| faults[i].clone()).collect()
    };
    let is_superfluous = |group: &Vec<usize>| {
        let others: Vec<&MeasurementFault> = group.iter().map(|i| &faults[*i]).collect();
        are_needed(&others, &kept(group), measurement, answer, request, observer) == Some(false)
    };
    groups.find(is_superfluous).map(|group| kept(&group))
}

/// Whether the model of an answer, fitted to the measurement with only the `kept` faults mended,
/// leaves more than noise, or more of what the others explain than chance does; `None` if nothing can be
/// said.
fn are_needed(
    others: &[&MeasurementFault],
    kept: &[MeasurementFault],
    measurement: &Measurement,
    answer: &Diagnosis,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<bool> {
    if answer.causes.is_empty() {
        // The base model alone was tried before any fault was looked for.
        return None;
    }
    let whole = mending::mended(measurement, kept).ok()?.measurement;
    let actuator_order = order(answer);
    let request = IdentifyRequest { plant: Some(PlantRequest { actuator_order }), ..*request };
    let mut session = FitSession::new(&whole, &request, observer).ok()?;
    let extended = answer.extended.as_ref()?;
    if !session.has_weights_of(extended).ok()? {
        session = session.weighted_by(extended, observer).ok()?;
    }
    let mut model = session.base().clone();
    for cause in &answer.causes {
        model = session.extend(&model, effects::find(&cause.effect)?);
    }
    let model = session.at_reported(&model, extended)?;
    let model = session.refine(&model, FitAccuracy::Settle);
    let seed = request.options.seed;
    let is_noise = |model: &Model| discrepancy::leaves_noise(&session, model, seed);
    if is_noise(&model) {
        return Some(show(others, &session, &model, seed));
    }
    // The model may be in a local minimum that only the data without the faults speak for.
    let (part, noise_scale) = (Part::of(observer), NoiseScale::of(&session));
    let fitter = Fitter { session: &session, part, noise_scale, starts: 1, followed: 1 };
    let begin = &mut |restarts| part.stage("further starts", restarts);
    let found = fitter.leave_local_minimum(&model, &is_noise, begin)?;
    Some(!is_noise(&found) || show(others, &session, &found, seed))
}

/// Whether one of these faults of a table explains more than chance of what a model leaves.
fn show(faults: &[&MeasurementFault], session: &FitSession<'_>, model: &Model, seed: u64) -> bool {
    let judged = session.has_cosines_alone().then(|| session.judge(model, Intervals::Curvature));
    let (Some(Ok(fit)), Some(cost)) = (judged, session.cost(model)) else { return false };
    let NoiseScale { dof, known, .. } = NoiseScale::of(session);
    let scan = Scan::new(&fit, cost, dof, known);
    let candidates = scan.candidates();
    let family = Family::of(&fit, &candidates, seed);
    let found = scan.select(&candidates, &family).faults;
    found.iter().any(|(new, _)| faults.iter().any(|fault| fault::place(fault) == fault::place(new)))
}

/// Order of the actuator in an answer.
pub(super) fn order(answer: &Diagnosis) -> u8 {
    let has = |name: &str| answer.base.parameters.contains_key(name);
    match (has("natural_frequency"), has("actuator_pole")) {
        (true, _) => 2,
        (_, true) => 1,
        _ => 0,
    }
}
