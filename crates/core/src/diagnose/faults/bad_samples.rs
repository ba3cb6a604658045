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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{Channel, Diagnosis, IdentifyOptions, Verdict};
    use crate::diagnose::fixtures::spoilt_record;
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::measurement::Record;
    use crate::observer::Silent;

    /// A spike of the response as large as a third of its largest value, and a gap of the input.
    fn spoil(record: &mut Record) {
        let largest = record.output.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        record.output[700] += largest / 3.0;
        record.input[1301..1304].fill(0.0);
    }

    fn answer(effects: &[Effect], keep_all: bool) -> Diagnosis {
        let options = IdentifyOptions { keep_all, ..IdentifyOptions::default() };
        let request = IdentifyRequest { options, ..IdentifyRequest::default() };
        let measurement = spoilt_record(effects, spoil, 5);
        crate::diagnose::diagnose(&measurement, &request, &Silent).unwrap()
    }

    #[test]
    fn bad_samples_are_named_where_they_are_and_the_rest_is_a_healthy_axis() {
        let found = answer(&[], false);
        assert_eq!(found.verdict, Verdict::Adequate, "{:?}", found.base.fit);
        let [fault] = found.measurement.as_slice() else { panic!("{:?}", found.measurement) };
        let places: Vec<_> =
            fault.interpolated.iter().map(|one| (one.channel, one.count)).collect();
        assert_eq!(places, [(Channel::Input, 3), (Channel::Response, 1)]);
        assert!(fault.sentence.starts_with("samples do not belong to the rest: 3 samples at "));
        assert!(fault.sentence.contains(" s: the input is "), "{}", fault.sentence);
        assert!(found.as_measured.is_some());
    }

    #[test]
    fn an_effect_behind_bad_samples_is_named() {
        let found = answer(&[Effect::new("gain_asymmetry", [("gamma", 0.15)])], false);
        assert_eq!(found.measurement[0].fault, FaultKind::BadSamples);
        assert_eq!(found.causes[0].effect, "gain_asymmetry");
    }

    #[test]
    fn all_samples_can_be_kept() {
        assert!(answer(&[], true).measurement.is_empty());
    }
}
