//! A record of which a channel clips.
//!
//! What was cut off of an input is filled in as the record is read, and then estimated with every model.
//! What is cut off of a response is cut off of the models' responses, too. Both are rivals of the effects: where the machine stood still,
//! or the input was held, a model explains the record as it is better.

use crate::answers::{FaultKind, MeasurementFault};
use crate::measurement::{Clipping, Experiment};

/// A fault for each channel that seems to clip.
pub(super) fn faults(experiments: &[Experiment]) -> Vec<MeasurementFault> {
    let largest = |share: &dyn Fn(&Clipping) -> f64| {
        let clipping = experiments.iter().filter_map(|experiment| experiment.clipping.as_deref());
        clipping.map(share).fold(0.0, f64::max)
    };
    let shares = [
        (FaultKind::ClippedInput, largest(&|clipping| clipping.input_share)),
        (FaultKind::ClippedResponse, largest(&|clipping| clipping.response_share)),
    ];
    let clipped = shares.into_iter().filter(|(_, share)| *share > 0.0);
    clipped
        .map(|(kind, share)| MeasurementFault { value: Some(share), ..MeasurementFault::of(kind) })
        .collect()
}

/// The experiment with its input filled in, and with the range of its response; `None` if no channel
/// of it is among the faults.
pub(super) fn mended(experiment: &Experiment, faults: &[MeasurementFault]) -> Option<Experiment> {
    let clipping = experiment.clipping.as_deref()?;
    let has = |kind: FaultKind| faults.iter().any(|fault| fault.fault == kind);
    let filled = clipping.filled.as_ref().filter(|_| has(FaultKind::ClippedInput));
    let range = clipping.range.filter(|_| has(FaultKind::ClippedResponse));
    if filled.is_none() && range.is_none() {
        return None;
    }
    Some(Experiment { range, clipping: None, ..filled.unwrap_or(experiment).clone() })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::answers::{Diagnosis, Verdict};
    use crate::diagnose::fixtures::plant;
    use crate::identify::IdentifyRequest;
    use crate::machines::records::multisine;
    use crate::machines::simulator::{Effect, Machine, Settings, respond};
    use crate::measurement::{Complex, Measurement, Metadata, Record, RecordStatement};
    use crate::observer::Silent;

    const SAMPLES: usize = 1024;
    const PERIODS: usize = 4;
    const OMEGA_RAD_S: f64 = 2.0;

    /// The answer to a record of four periods with noise of 0.3 % of the largest value, of which the
    /// channels read up to these shares of their largest values.
    fn answer(effects: &[Effect], shares: [f64; 2]) -> Diagnosis {
        answer_of_periods(PERIODS, effects, shares)
    }

    /// The same to a record of so many periods.
    fn answer_of_periods(
        periods: usize,
        effects: &[Effect],
        [input, response]: [f64; 2],
    ) -> Diagnosis {
        let rng = &mut ChaCha8Rng::seed_from_u64(5);
        let lines = multisine(40, 2.0, rng);
        let (machine, settings) = (Machine { plant: plant(), effects }, Settings::default());
        let moved =
            respond(&machine, 0.0, OMEGA_RAD_S, &lines, SAMPLES / 2 - 1, &settings).unwrap();
        let mut sampled = |lines: &[Complex], share: f64, noise: f64| {
            let at = |n: usize| {
                let turn = |k: usize| Complex::cis(TAU * (k * n % SAMPLES) as f64 / SAMPLES as f64);
                lines.iter().enumerate().map(|(k, line)| (line * turn(k)).re).sum::<f64>()
            };
            let period: Vec<f64> = (0..SAMPLES).map(at).collect();
            let largest = period.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let read = |value: &f64| {
                let scatter: f64 = StandardNormal.sample(rng);
                (value + noise * largest * scatter).clamp(-share * largest, share * largest)
            };
            (0..periods).flat_map(|_| &period).map(read).collect::<Vec<f64>>()
        };
        let period_s = TAU / OMEGA_RAD_S;
        let record = Record {
            time_s: (0..SAMPLES * periods).map(|n| n as f64 * period_s / SAMPLES as f64).collect(),
            input: sampled(&lines, input, 0.0),
            output: sampled(&moved, response, 3e-3),
            run: None,
        };
        let stated = RecordStatement { period_s: Some(period_s), ..RecordStatement::default() };
        let (experiment, _) = record.experiment(stated).unwrap();
        let (metadata, hash) = (Metadata::default(), String::new());
        let measurement = Measurement::new(metadata, vec![experiment], Vec::new(), hash).unwrap();
        crate::diagnose::diagnose(&measurement, &IdentifyRequest::default(), &Silent).unwrap()
    }

    fn kinds(answer: &Diagnosis) -> Vec<FaultKind> {
        answer.measurement.iter().map(|fault| fault.fault).collect()
    }

    #[test]
    fn a_channel_that_clips_is_named_and_mended() {
        for (ends, kind) in
            [([2.0, 0.7], FaultKind::ClippedResponse), ([0.7, 2.0], FaultKind::ClippedInput)]
        {
            let found = answer(&[], ends);
            assert_eq!(kinds(&found), [kind], "{:?}", found.verdict);
            assert_eq!(found.verdict, Verdict::Adequate, "{kind:?} {:?}", found.base.fit);
        }
    }

    // Read up to a quarter of its largest value, the input is filled in so wrongly that the base model
    // leaves 4 %.
    #[test]
    fn samples_of_an_input_that_were_cut_off_are_estimated_with_the_model() {
        let found = answer_of_periods(1, &[], [0.25, 2.0]);
        assert_eq!(kinds(&found), [FaultKind::ClippedInput], "{:?}", found.verdict);
        assert_eq!(found.verdict, Verdict::Adequate, "{:?}", found.base.fit);
    }

    #[test]
    fn an_effect_behind_a_channel_that_clips_is_named() {
        let found = answer(&[Effect::new("gain_asymmetry", [("gamma", 0.15)])], [2.0, 0.7]);
        assert_eq!(kinds(&found), [FaultKind::ClippedResponse], "{:?}", found.verdict);
        assert_eq!(found.causes[0].effect, "gain_asymmetry");
    }

    #[test]
    fn a_channel_that_does_not_clip_has_no_fault() {
        let found = answer(&[], [2.0, 2.0]);
        assert_eq!(kinds(&found), []);
        assert_eq!(found.verdict, Verdict::Adequate, "{:?}", found.causes);
    }

    // The command of an amplifier that saturates is read as it is.
    #[test]
    fn an_amplifier_that_saturates_is_no_channel_that_clips() {
        let found = answer(&[Effect::new("actuator_saturation", [("limit", 1.2)])], [2.0, 2.0]);
        assert_eq!(kinds(&found), []);
        assert_eq!(found.causes[0].effect, "actuator_saturation");
    }
}
