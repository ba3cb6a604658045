//! How the input of a record runs between its samples.
//!
//! A command that a converter holds until the next sample acts half a sample later than the smoothest
//! course through its samples. A healthy axis then seems to have a delay. The three courses have no
//! parameter and are as probable before.

use crate::answers::{FaultKind, MeasurementFault};
use crate::identify::FitSession;

use super::mending;
use super::suspects::Suspects;

/// The courses that are tried.
pub(super) const COURSES: [FaultKind; 2] = [FaultKind::HeldInput, FaultKind::StraightInput];

/// Cost of a course in −2 ln evidence: 2 ln 3, one of three.
pub(super) const ONE_OF_THREE: f64 = 2.197;

/// What it costs beside that where it saves no effect: 2 ln 100. The likelihood of a wrong course
/// exceeds that of the right one a hundred times in less than one of a hundred measurements, whatever
/// the courses (Markov's inequality of the likelihood ratio).
pub(super) const SAVES_NONE: f64 = 9.21;

/// Models that leave more per degree of freedom are not brought down to the noise by a course of the
/// input, which changes the response by a few per cent at most. As for the choice of weights, tuned.
pub(super) const MOST_LEFT: f64 = 20.0;

/// The data with another course of the input; `None` where it is known how the input runs.
pub(super) fn with<'a>(suspects: &Suspects<'a>, kind: FaultKind) -> Option<FitSession<'a>> {
    let experiments = suspects.session.measurement().experiments();
    let samples: Vec<f64> =
        experiments.iter().map(|experiment| experiment.open_samples).collect::<Option<_>>()?;
    let course = mending::course(&[MeasurementFault::of(kind)])?;
    suspects.session.with_input(|index, k| course.factor(k, samples[index]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{PlantRequest, Verdict};
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::measurement::Intersample;
    use crate::observer::Silent;

    /// What is found in a record of a healthy axis whose input runs in this way between its samples.
    fn found(course: Option<Intersample>, seed: u64) -> (Verdict, Vec<FaultKind>) {
        let measurement = multisine_record(plant(), &[], course, seed);
        let request = IdentifyRequest::default();
        let answer = crate::diagnose::diagnose(&measurement, &request, &Silent).unwrap();
        (answer.verdict, answer.measurement.iter().map(|fault| fault.fault).collect())
    }

    #[test]
    fn an_input_that_is_held_or_runs_straight_is_no_fault_of_the_machine() {
        for (course, kind) in [(Intersample::Hold, COURSES[0]), (Intersample::Linear, COURSES[1])] {
            assert_eq!(found(Some(course), 3), (Verdict::Adequate, vec![kind]), "{course:?}");
        }
    }

    // A sensor that reads less the faster the axis moves is no effect of the library.
    #[test]
    fn a_held_input_is_found_beside_what_no_effect_explains() {
        let effects = [
            Effect::new("gain_asymmetry", [("gamma", 0.15)]),
            Effect::new("sensor_compression", [("e", 0.3)]),
        ];
        let plant_request = Some(PlantRequest { actuator_order: 1 });
        let request = IdentifyRequest { plant: plant_request, ..IdentifyRequest::default() };
        let found = |course| {
            let measurement = multisine_record(plant(), &effects, course, 3);
            let answer = crate::diagnose::diagnose(&measurement, &request, &Silent).unwrap();
            let faults: Vec<FaultKind> = answer.measurement.iter().map(|f| f.fault).collect();
            (answer.verdict, answer.causes[0].effect.clone(), faults)
        };
        let improved = |faults| (Verdict::Improved, "gain_asymmetry".to_owned(), faults);
        assert_eq!(found(Some(Intersample::Hold)), improved(vec![FaultKind::HeldInput]));
        assert_eq!(found(None), improved(vec![]));
    }

    #[test]
    fn an_input_that_is_read_as_it_runs_has_no_fault() {
        for seed in 0..4 {
            assert_eq!(found(None, seed), (Verdict::Adequate, vec![]), "{seed}");
        }
    }
}
