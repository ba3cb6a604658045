//! How the input of a record runs between its samples.
//!
//! A command that a converter holds until the next sample acts half a sample later than the smoothest
//! course through its samples. A healthy axis then seems to have a delay. The three courses have no
//! parameter and are as probable before. Another course is found in two cases: with it a model leaves
//! only noise; or more than noise remains whatever is tried, and one effect of the best model is not
//! needed with it. A machine with small effects beside its large ones is of the second kind.

use crate::answers::{FaultKind, MeasurementFault};
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::selection::evidence;
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

/// Models that are tried with each course where the best leaves only noise: those of most evidence,
/// and all that are parts of the best.
const MOST_TRIED: usize = 4;

/// Models that leave more per degree of freedom are not brought down to the noise by a course of the
/// input, which changes the response by a few per cent at most. As for the choice of weights, tuned.
const MOST_LEFT: f64 = 20.0;

/// The best model with another course of the input, if it is better than every model without.
pub(super) fn best(suspects: &Suspects<'_>, wanted: impl Fn(&Key) -> bool) -> Option<Suspected> {
    let Suspects { session, models, combined, .. } = *suspects;
    let experiments = session.measurement().experiments();
    let samples: Vec<f64> =
        experiments.iter().map(|experiment| experiment.open_samples).collect::<Option<_>>()?;
    let misfit = |model: &Model| misfit_of_noise(suspects, model.cost);
    let criterion = |key: &Key, model: &Model| misfit(model) + models.complexity(key);
    let mut ranked: Vec<(&Key, &Model)> = models.all().collect();
    ranked.sort_by(|a, b| criterion(a.0, a.1).total_cmp(&criterion(b.0, b.1)));
    let (best_key, best_model) = *ranked.first()?;
    let without = criterion(best_key, best_model);
    let more_is_left = combined && !models.noise_scale.explains(best_model.cost);
    let tried: Vec<Model> = if more_is_left {
        (0..best_key.len()).map(|effect| session.reduce(best_model, effect)).collect()
    } else {
        let is_near =
            |model: &Model| !suspects.size_known() || model.cost < MOST_LEFT * suspects.dof();
        let is_part = |key: &Key| key.iter().all(|id| best_key.contains(id));
        let mut near = ranked.into_iter().filter(|(key, model)| wanted(key) && is_near(model));
        let mut tried: Vec<_> = near.by_ref().take(MOST_TRIED).collect();
        tried.extend(near.filter(|(key, _)| is_part(key)));
        tried.into_iter().map(|(_, model)| model.clone()).collect()
    };
    let mut best: Option<Suspected> = None;
    let mut least = without;
    for kind in COURSES {
        let faults = vec![MeasurementFault::of(kind)];
        let course = mending::course(&faults)?;
        let Some(session) = session.with_input(|index, k| course.factor(k, samples[index])) else {
            continue;
        };
        for start in &tried {
            let fitted = session.refine(start, FitAccuracy::Settle);
            let effects = fitted.effects().len();
            let saves = effects < best_key.len();
            let price = ONE_OF_THREE + if saves { 0.0 } else { SAVES_NONE };
            let complexity = evidence::complexity(&session, &fitted, &models.noise_scale);
            if misfit(&fitted) + complexity + price >= least {
                continue;
            }
            let model = session.verified(&fitted);
            let criterion = misfit(&model) + complexity + price;
            if criterion >= least {
                continue;
            }
            let Ok(fit) = session.judge(&model, Intervals::Curvature) else { continue };
            let observer = session.observer();
            if more_is_left || discrepancy::is_noise(&fit, suspects.seed, observer) {
                least = criterion;
                let (faults, criterion) =
                    (faults.clone(), suspects.best_without() - (without - criterion));
                best = Some(Suspected { faults, criterion, price, effects });
            }
        }
    }
    best
}

/// −2 ln likelihood of a cost where the noise is as large as stated or larger, whichever is likelier.
fn misfit_of_noise(suspects: &Suspects<'_>, cost: f64) -> f64 {
    let dof = suspects.dof();
    misfit(cost, dof, suspects.size_known() && cost <= dof)
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
