//! What the answer to a measurement with its faults would be.

use crate::answers::{AsMeasured, Diagnosis, IdentifyOptions, NetworkOptions, PlantRequest};
use crate::diagnose::progress::{Part, Quiet};
use crate::identify::{FitSession, IdentifyRequest};
use crate::measurement::Measurement;

use super::readings;

/// A complete answer to the measurement as it is.
pub(super) fn as_answered(answer: &Diagnosis) -> AsMeasured {
    AsMeasured {
        nrmse: answer.base.fit.nrmse,
        chi2_per_dof: answer.base.fit.chi2_per_dof,
        causes: answer.causes.iter().map(|cause| cause.effect.clone()).collect(),
        nrmse_with_causes: answer.extended.as_ref().map(|extended| extended.fit.nrmse),
    }
}

/// What the base model of this order leaves of the measurement as it is. Its network would take more time
/// than it saves.
pub(super) fn base_alone(
    measurement: &Measurement,
    actuator_order: u8,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Option<AsMeasured> {
    let quietly = Quiet(part);
    let network = NetworkOptions { enabled: false, ..request.options.network };
    let options = IdentifyOptions { network, ..request.options };
    let plant = Some(PlantRequest { actuator_order });
    let request = IdentifyRequest { plant, options, ..*request };
    let session = FitSession::new(measurement, &request, &quietly).ok()?;
    readings::as_measured(&session)
}
