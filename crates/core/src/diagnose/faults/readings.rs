//! Ways in which a whole file may have been read wrongly: the response conjugated or of the wrong
//! sign, a sine for the cosine as reference, another quantity than stated.
//!
//! Each has no parameter. The base model is fitted to the measurement read in each way. A wrong
//! reading leaves a large part of the response, and the right one far less, whatever effects the
//! machine has.

use crate::answers::{
    AsMeasured, Diagnosis, FaultKind, IdentifyOptions, MeasurementFault, NetworkOptions, Verdict,
    Weighting,
};
use crate::identify::{FitSession, IdentifyRequest, Intervals};
use crate::measurement::{Measurement, ResponseKind};
use crate::observer::Observer;

use super::{mending, power};
use crate::diagnose::doubt::{Halt, Suspicion};
use crate::diagnose::progress::{Part, Quiet};

/// Another reading is tried only where the base model leaves more than this of the response.
const LEAST_LEFT: f64 = 0.01;
/// The same where inputs have many lines, so that a fit takes seconds, unless power says
/// that the sign is wrong.
const LEAST_LEFT_OF_RECORD: f64 = 0.9;

/// Fewest real data that tell readings apart.
const FEWEST_DATA: usize = 30;

/// Other readings are diagnosed if the best model leaves more than this.
const LEAST_LEFT_UNEXPLAINED: f64 = 0.02;
/// Other readings of a record are tried if the best model leaves more than this. A diagnosis of each
/// would take too long, so that the base model alone must tell which is right.
const LEAST_LEFT_UNEXPLAINED_OF_RECORD: f64 = 0.5;

/// Another reading is right if it leaves less than this share of what the stated one leaves (rms).
const CLEARLY_LESS: f64 = 0.3;

/// The readings that are not the stated one.
fn others(measurement: &Measurement) -> Vec<MeasurementFault> {
    let stated = measurement.metadata().response_kind;
    let kinds = [
        (ResponseKind::Velocity, "velocity"),
        (ResponseKind::Position, "position"),
        (ResponseKind::Acceleration, "acceleration"),
    ];
    let another =
        kinds.into_iter().filter(|(kind, _)| *kind != stated).map(|(_, name)| MeasurementFault {
            response: Some(name.to_owned()),
            ..MeasurementFault::of(FaultKind::ResponseKind)
        });
    // Lines of a record are computed from its samples, in the convention that is wanted.
    let conventions = [FaultKind::Conjugated, FaultKind::SineReference].into_iter();
    let is_table = measurement.experiments().iter().all(|experiment| !experiment.from_record);
    let read = conventions.filter(|_| is_table).chain([FaultKind::ReversedSign]);
    read.map(MeasurementFault::of).chain(another).collect()
}

/// What the base model of a session leaves of the response.
fn left(session: &FitSession<'_>) -> Option<f64> {
    let fit = session.judge(session.base(), Intervals::Curvature).ok()?;
    Some(fit.identification.fit.nrmse).filter(|nrmse| nrmse.is_finite())
}

/// What the base model leaves of a measurement that is read in another way, and that measurement.
fn read_as(
    reading: &MeasurementFault,
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<(f64, Measurement)> {
    let read = mending::mended(measurement, std::slice::from_ref(reading)).ok()?.measurement;
    Some((left_of(&read, request, observer)?, read))
}

/// What the base model leaves of a measurement.
fn left_of(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<f64> {
    // The colony alone is good enough to tell readings apart, and twice as fast.
    let network = NetworkOptions { enabled: false, ..request.options.network };
    let options = IdentifyOptions { network, ..request.options };
    let request = IdentifyRequest { options, ..*request };
    left(&FitSession::new(measurement, &request, observer).ok()?)
}

/// The reading of a measurement of which nothing explained what the best model leaves, if one effect
/// explains it in another reading; or, of a record, if the base model leaves far less. Only readings of
/// which the base model leaves less are tried; `diagnosed` answers without doubting the measurement.
pub(super) fn explained(
    answer: &Diagnosis,
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
    diagnosed: &dyn Fn(&Measurement, &IdentifyRequest) -> Option<Diagnosis>,
) -> Option<MeasurementFault> {
    let best = |answer: &Diagnosis| answer.extended.as_ref().unwrap_or(&answer.base).fit.nrmse;
    let is_table = measurement.experiments().iter().all(|e| e.pure_cosine().is_some());
    let least = if is_table { LEAST_LEFT_UNEXPLAINED } else { LEAST_LEFT_UNEXPLAINED_OF_RECORD };
    if best(answer) <= least {
        return None;
    }
    if !is_table {
        return clearly_better(best(answer), others(measurement), measurement, request, observer);
    }
    let options = IdentifyOptions { most_effects: 1, ..request.options };
    let alone = IdentifyRequest { options, ..*request };
    others(measurement).into_iter().find(|reading| {
        let read = read_as(reading, measurement, request, observer);
        let better = read.filter(|(left, _)| *left < answer.base.fit.nrmse);
        let other = better.and_then(|(_, read)| diagnosed(&read, &alone));
        other.is_some_and(|other| {
            matches!(other.verdict, Verdict::Adequate | Verdict::Explained)
                && best(&other) < CLEARLY_LESS * best(answer)
        })
    })
}

/// The reading of a measurement that is clearly right where the stated one is wrong.
fn better(
    session: &FitSession<'_>,
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<MeasurementFault> {
    if session.data() < FEWEST_DATA {
        return None;
    }
    let as_stated = left(session)?;
    if as_stated <= LEAST_LEFT {
        return None;
    }
    let of_others = |others| clearly_better(as_stated, others, measurement, request, observer);
    if session.has_cosines_alone() || as_stated > LEAST_LEFT_OF_RECORD {
        return of_others(others(measurement));
    }
    let reversed = MeasurementFault::of(FaultKind::ReversedSign);
    power::is_reversed(measurement).then(|| of_others(vec![reversed])).flatten()
}

/// That of these readings of which the base model leaves least, if that is far less than what is left of
/// the stated one, with equal weights as well. With those of the noise, small harmonics that repeat well
/// can make a fit leave most of the response.
fn clearly_better(
    as_stated: f64,
    others: Vec<MeasurementFault>,
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<MeasurementFault> {
    let read = others.into_iter().filter_map(|reading| {
        let (left, _) = read_as(&reading, measurement, request, observer)?;
        Some((left, reading))
    });
    let best = read.min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, reading) = best.filter(|(left, _)| *left < CLEARLY_LESS * as_stated)?;
    let options = IdentifyOptions { weights: Weighting::Response, ..request.options };
    let equally = IdentifyRequest { options, ..*request };
    let as_stated = left_of(measurement, &equally, observer)?;
    let (as_read, _) = read_as(&reading, measurement, &equally, observer)?;
    (as_read < CLEARLY_LESS * as_stated).then_some(reading)
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
pub(in crate::diagnose) fn misread(
    session: &FitSession<'_>,
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: &Part<'_>,
) -> Option<Halt> {
    let reading = better(session, measurement, request, &Quiet(part))?;
    let as_measured = as_measured(session)?;
    Some(Halt::Faults(Box::new(Suspicion { faults: vec![reading], as_measured })))
}

#[cfg(test)]
mod tests {
    use super::{better, left};
    use crate::answers::{FaultKind, Verdict};
    use crate::diagnose::fixtures::{in_a_position_loop, multiplied, multisine_record_of, plant};
    use crate::identify::{FitSession, IdentifyRequest};
    use crate::machines::draw::{Draw, NoiseStatement, measure};
    use crate::machines::simulator::Effect;
    use crate::measurement::{Complex, Measurement, Metadata, ResponseKind};
    use crate::observer::Silent;
    use crate::plant::{Actuator, Friction, Plant};

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// The faults of a measurement whose response has the wrong sign, and the verdict once it is right.
    fn found(sound: &Measurement) -> (Vec<FaultKind>, Verdict) {
        let wrong = multiplied(sound, |_, _| -Complex::ONE);
        let request = IdentifyRequest::default();
        let answer = crate::diagnose::diagnose(&wrong, &request, &Silent).unwrap();
        (answer.measurement.iter().map(|fault| fault.fault).collect(), answer.verdict)
    }

    #[test]
    fn a_record_of_the_wrong_sign_is_told_by_what_it_is() {
        let reversed = (vec![FaultKind::ReversedSign], Verdict::Adequate);
        for kind in [ResponseKind::Velocity, ResponseKind::Position] {
            assert_eq!(found(&multisine_record_of(kind, plant(), &[], None, 5)), reversed);
        }
        // A hardening spring follows all but a sixth of it.
        assert_eq!(found(&in_a_position_loop(1)), reversed);
    }

    /// A table of an axis whose amplifier saturates at the highest magnitude, with nearly the same friction
    /// in both directions, and noise in proportion to each harmonic above a floor.
    fn saturating() -> Measurement {
        let actuator = Actuator::SecondOrder { natural_frequency_rad_s: 83.0, damping_ratio: 0.39 };
        let friction = Friction::coulomb(0.156, 0.153);
        let plant = Plant { viscous_rate_rad_s: 14.0, constant: 23.0, actuator, friction };
        let effects = vec![Effect::new("actuator_saturation", [("limit", 0.82)])];
        let omegas = (0..14).map(|i| 2.8 * 40f64.powf(f64::from(i) / 13.0));
        let design = omegas.flat_map(|omega| [0.47, 0.78, 1.3].map(|m| (m, omega))).collect();
        let (noise_db, noise_statement) = (None, NoiseStatement::Silent);
        let draw = Draw { plant, effects, design, harmonics: 3, noise_db, noise_statement };
        let mut experiments = measure(&draw, 1).unwrap().experiments().to_vec();
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        for harmonic in experiments.iter_mut().flat_map(|experiment| &mut experiment.response) {
            let size = (0.004 * harmonic.value.norm()).hypot(3e-4);
            let mut scatter = || -> f64 { StandardNormal.sample(rng) };
            let (re, im) = (scatter(), if harmonic.order > 0 { scatter() } else { 0.0 });
            harmonic.value += Complex::new(size * re, size * im);
        }
        Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap()
    }

    #[test]
    fn a_fit_to_small_harmonics_alone_does_not_make_a_wrong_reading_right() {
        let (measurement, request) = (saturating(), IdentifyRequest::default());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        assert!(left(&session).unwrap() > 0.5, "the fit follows the fundamental");
        assert_eq!(better(&session, &measurement, &request, &Silent), None);
    }
}
