//! Whether the experiment that a diagnosis asks for tells its cause from the rivals.

use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::{Candidate, Diagnosis, NextExperiment};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::observer::Observer;

use super::build_case::{Made, statement};
use super::{Case, MakeError};
use crate::machines::draw::{Draw, DrawError, log_uniform};
use crate::machines::responses::Responses;
use crate::machines::simulator::Settings;

/// Frequencies of random experiments, in units of the highest that was measured.
const BEYOND: f64 = 4.0;

/// What one more experiment did to a doubt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Separation {
    /// Lead of the hidden effect before it: by how much the criterion of the best other
    /// candidate exceeds its own.
    pub lead: f64,
    /// After the experiment that was asked for.
    pub asked_for: Separated,
    /// After one at a magnitude from the range of the others and a frequency from theirs or up
    /// to four times as high.
    pub random: Separated,
}

/// Where a doubt stands after one more experiment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Separated {
    /// Whether the hidden effect alone is left as the cause.
    pub ended: bool,
    /// Lead of the hidden effect.
    pub lead: f64,
}

impl Separation {
    /// Whether the experiment that was asked for speaks more for the hidden effect.
    pub fn asked_for_is_better(&self) -> bool {
        self.asked_for.lead > self.random.lead
    }
}

/// Adds to a draw the experiment that its diagnosis asks for and, apart from it, a random
/// one, measured as the others were, and has both diagnosed. `None` where nothing is asked
/// for, or the machine has no response there.
///
/// # Errors
/// See [`MakeError`].
pub(super) fn separate(
    case: &Case,
    made: &Made,
    diagnosis: &Diagnosis,
    request: &IdentifyRequest,
    rng: &mut ChaCha8Rng,
    observer: &dyn Observer,
) -> Result<Option<Separation>, MakeError> {
    let Some(NextExperiment { magnitude, omega_rad_s, .. }) = diagnosis.next_experiment else {
        return Ok(None);
    };
    let random = random_point(&made.machine, rng);
    let mut separates = |point| -> Result<Option<Separated>, MakeError> {
        let Some(measurement) = with_experiment(case, made, point, rng)? else { return Ok(None) };
        let answer = diagnose(&measurement, request, observer)?;
        let first = answer.causes.first();
        let ended = first.is_some_and(|c| made.hides(&c.effect) && c.equivalents.is_empty());
        Ok(lead(made, &answer.candidates).map(|lead| Separated { ended, lead }))
    };
    let both = (separates((magnitude, omega_rad_s))?, separates(random)?);
    Ok(match (lead(made, &diagnosis.candidates), both) {
        (Some(lead), (Some(asked_for), Some(random))) => {
            Some(Separation { lead, asked_for, random })
        }
        _ => None,
    })
}

/// By how much a hidden effect that is alone leads; `None` where it was not tried.
fn lead(made: &Made, candidates: &[Candidate]) -> Option<f64> {
    let all = || candidates.iter();
    let own = all().find(|candidate| made.hides(&candidate.effect))?;
    let others = all().filter(|candidate| !made.hides(&candidate.effect));
    Some(others.map(|other| other.criterion).fold(f64::INFINITY, f64::min) - own.criterion)
}

/// Uniform in the logarithms of magnitude and frequency over a design and beyond.
fn random_point(machine: &Draw, rng: &mut ChaCha8Rng) -> (f64, f64) {
    let mut within = |value: fn(&(f64, f64)) -> f64, beyond: f64| {
        let values = || machine.design.iter().map(value);
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        log_uniform(least, beyond * most, rng)
    };
    (within(|point| point.0, 1.0), within(|point| point.1, BEYOND))
}

/// The measurement with one more experiment at the end of the acquisition.
fn with_experiment(
    case: &Case,
    made: &Made,
    point: (f64, f64),
    rng: &mut ChaCha8Rng,
) -> Result<Option<Measurement>, MakeError> {
    // What drifts has drifted by then: the point is the second of two.
    let design = made.machine.design.last().copied().into_iter().chain([point]).collect();
    let machine = Draw { design, ..made.machine.clone() };
    let responses = Responses::simulate(&machine, &Settings::default())?;
    let added = responses.experiments_with(made.noise_std, statement(case), rng);
    let last = made.measurement.experiments().iter().filter_map(|e| e.run).fold(0.0, f64::max);
    let Some(mut added) = added.into_iter().find(|added| added.run == Some(1.0)) else {
        return Ok(None);
    };
    added.run = Some(last);
    Ok(Some(made.measurement.with(added).map_err(DrawError::from)?))
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::super::sizing::Sizing;
    use super::*;
    use crate::naming::build_case;

    #[test]
    fn one_more_experiment_stands_at_the_end_and_is_as_noisy_as_the_others() {
        for key in ["single-50-friction_drift-o0-0", "single-50-gain_asymmetry-o0-4"] {
            let case: Case = key.parse().unwrap();
            let made = build_case(&case, 1, Sizing::Amount, &Silent).unwrap();
            let rng = &mut case.rng(2);
            let (magnitude, omega) = random_point(&made.machine, rng);
            let extended = with_experiment(&case, &made, (magnitude, omega), rng).unwrap().unwrap();
            let [.., before, added] = extended.experiments() else { panic!("two experiments") };
            assert_eq!(extended.experiments().len(), made.measurement.experiments().len() + 1);
            assert_eq!((added.magnitude, added.omega_rad_s), (magnitude, omega));
            assert_eq!((added.run, added.repeats.len()), (before.run, before.repeats.len()));
            assert_eq!(added.response[1].std, before.response[1].std);
            let lowest = made.machine.design[0];
            assert!(magnitude >= lowest.0 && magnitude <= 4.0 * lowest.0 && omega >= lowest.1);
        }
    }

    #[test]
    fn a_hidden_effect_leads_by_what_the_best_other_is_behind() {
        let case: Case = "single-50-gain_asymmetry-o0-4".parse().unwrap();
        let made = build_case(&case, 1, Sizing::Amount, &Silent).unwrap();
        let candidate = |(effect, criterion): &(&str, f64)| Candidate {
            effect: (*effect).to_owned(),
            cost: 0.0,
            delta_chi2: 0.0,
            criterion: *criterion,
            heldout_error: None,
            rejected: None,
        };
        let led = |criteria: &[(&str, f64)]| {
            lead(&made, &criteria.iter().map(candidate).collect::<Vec<_>>())
        };
        let (hidden, spring) = (("gain_asymmetry", 610.0), ("spring", 640.0));
        assert_eq!(led(&[hidden, spring]), Some(30.0));
        assert_eq!(led(&[hidden, spring, ("cogging", 607.0)]), Some(-3.0));
        assert_eq!(led(&[spring]), None);
    }
}
