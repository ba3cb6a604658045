//! How the input of a record runs between its samples.
//!
//! A command that a converter holds until the next sample acts half a sample later than the smoothest
//! course through its samples. A healthy axis then seems to have a delay. The three courses have no
//! parameter and are as probable before; where one of the other two and fewer effects leave only noise,
//! it is the better explanation.

use crate::answers::{FaultKind, MeasurementFault};
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::selection::models::Key;
use crate::identify::{FitAccuracy, Intervals, Model};

use super::mending;
use super::suspects::{Suspected, Suspects, misfit};

/// The courses that are tried.
const COURSES: [FaultKind; 2] = [FaultKind::HeldInput, FaultKind::StraightInput];

/// Cost of a course in −2 ln evidence: 2 ln 3, one of three.
const ONE_OF_THREE: f64 = 2.197;

/// What it costs beside that where it saves no effect: 2 ln 100. The likelihood of a wrong course
/// exceeds that of the right one a hundred times in less than one of a hundred measurements, whatever
/// the courses (Markov's inequality of the likelihood ratio).
const SAVES_NONE: f64 = 9.21;

/// Models that are tried with each course: those of most evidence, and all that are parts of the best.
const MOST_TRIED: usize = 4;

/// Models that leave more per degree of freedom are not brought down to the noise by a course of the
/// input, which changes the response by a few per cent at most. As for the choice of weights, tuned.
const MOST_LEFT: f64 = 20.0;

/// The best model with another course of the input, if it leaves only noise and is better than every
/// model without.
pub(super) fn best(suspects: &Suspects<'_>, wanted: impl Fn(&Key) -> bool) -> Option<Suspected> {
    let experiments = suspects.session.measurement().experiments();
    let samples: Vec<f64> =
        experiments.iter().map(|experiment| experiment.open_samples).collect::<Option<_>>()?;
    let (dof, known) = (suspects.dof(), suspects.size_known());
    let criterion =
        |key: &Key, model: &Model| misfit(model.cost, dof, known) + suspects.models.complexity(key);
    let near = |model: &Model| !known || model.cost < MOST_LEFT * dof;
    let all = suspects.models.all().filter(|(key, model)| wanted(key) && near(model));
    let mut tried: Vec<(&Key, &Model)> = all.collect();
    tried.sort_by(|a, b| criterion(a.0, a.1).total_cmp(&criterion(b.0, b.1)));
    let best_key = tried.first().map_or_else(Key::new, |(key, _)| (*key).clone());
    let mut place = 0;
    tried.retain(|(key, _)| {
        place += 1;
        place <= MOST_TRIED || key.iter().all(|id| best_key.contains(id))
    });
    let mut best: Option<Suspected> = None;
    let mut bar = suspects.best_without();
    for kind in COURSES {
        let faults = vec![MeasurementFault::of(kind)];
        let course = mending::course(&faults)?;
        let session = suspects.session.with_input(|index, k| course.factor(k, samples[index]));
        for (key, model) in &tried {
            let model = session.refine(model, FitAccuracy::Settle);
            let saves = key.len() < best_key.len();
            let price = ONE_OF_THREE + if saves { 0.0 } else { SAVES_NONE };
            let criterion = criterion(key, &model) + price;
            if criterion >= bar {
                continue;
            }
            let Ok(fit) = session.judge(&model, Intervals::Curvature) else { continue };
            if discrepancy::is_noise(&fit, suspects.seed, session.observer()) {
                bar = criterion;
                let (faults, effects) = (faults.clone(), key.len());
                best = Some(Suspected { faults, criterion, price, effects });
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::Verdict;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::identify::IdentifyRequest;
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

    #[test]
    fn an_input_that_is_read_as_it_runs_has_no_fault() {
        for seed in 0..4 {
            assert_eq!(found(None, seed), (Verdict::Adequate, vec![]), "{seed}");
        }
    }
}
