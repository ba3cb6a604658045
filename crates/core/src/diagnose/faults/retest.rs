//! Whether faults are still needed beside the effects that are named in the end.
//!
//! A fault is found beside one effect at most. Where a second one is found in the mended measurement,
//! it may explain what was taken for a fault. So the final model is fitted to the measurement with
//! the faults: if it leaves only noise there, they are none.

use crate::answers::{Diagnosis, MeasurementFault, PlantRequest};
use crate::effects;
use crate::identify::{FitAccuracy, FitSession, IdentifyRequest, Intervals};
use crate::measurement::Measurement;
use crate::observer::Observer;

use crate::diagnose::residuals::discrepancy;

use super::mending;

/// Whether the model of an answer, fitted to the measurement with only the `kept` faults mended,
/// leaves more than noise.
pub(super) fn needs(
    measurement: &Measurement,
    kept: &[MeasurementFault],
    answer: &Diagnosis,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> bool {
    is_noise(measurement, kept, answer, request, observer) != Some(true)
}

fn is_noise(
    measurement: &Measurement,
    kept: &[MeasurementFault],
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
    let session = FitSession::new(&whole, &request, observer).ok()?;
    let mut model = session.base().clone();
    for cause in &answer.causes {
        model = session.extend(&model, effects::find(&cause.effect)?);
    }
    let model = session.at_reported(&model, answer.extended.as_ref()?)?;
    let model = session.refine(&model, FitAccuracy::Settle);
    let fit = session.judge(&model, Intervals::Curvature).ok()?;
    Some(discrepancy::is_noise(&fit, request.options.seed, observer))
}

fn order(answer: &Diagnosis) -> u8 {
    let has = |name: &str| answer.base.parameters.contains_key(name);
    match (has("natural_frequency"), has("actuator_pole")) {
        (true, _) => 2,
        (_, true) => 1,
        _ => 0,
    }
}
