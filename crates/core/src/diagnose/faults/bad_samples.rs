//! Samples of records that do not belong to the rest, which were found as the records were read.

use crate::answers::{FaultKind, InterpolatedSamples, MeasurementFault};
use crate::measurement::{Experiment, Measurement};

/// The bad samples of all records; `None` if there are none.
pub(super) fn fault(measurement: &Measurement) -> Option<MeasurementFault> {
    let experiments = measurement.experiments().iter().enumerate();
    let bad = experiments.filter_map(|(index, one)| Some((index, one.bad_samples.as_deref()?)));
    let interpolated: Vec<InterpolatedSamples> = bad
        .flat_map(|(experiment, bad)| {
            bad.samples.iter().map(move |one| InterpolatedSamples {
                experiment,
                channel: one.channel,
                time_s: one.time_s,
                line: one.line,
                count: one.count,
                off: one.off,
                sigmas: one.sigmas.min(f64::MAX),
            })
        })
        .collect();
    let found = MeasurementFault::of(FaultKind::BadSamples);
    (!interpolated.is_empty()).then_some(MeasurementFault { interpolated, ..found })
}

/// The experiment with its bad samples interpolated; `None` if they are not among the faults, or there
/// are none.
pub(super) fn mended<'e>(
    experiment: &'e Experiment,
    faults: &[MeasurementFault],
) -> Option<&'e Experiment> {
    let is_among = faults.iter().any(|fault| fault.fault == FaultKind::BadSamples);
    experiment.bad_samples.as_deref().filter(|_| is_among).map(|bad| &bad.mended)
}
