//! Tests whether the next experiment that a diagnosis proposes distinguishes its cause from the
//! rivals, compared with a random experiment.

use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::{Candidate, Diagnosis, NextExperiment};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::observer::Observer;

use super::MakeError;
use super::build_case::Made;
use crate::machines::draw::{Draw, DrawError, log_uniform};
use crate::machines::simulator::Settings;

/// Highest frequency of random experiments, as a multiple of the highest measured frequency.
const RANDOM_FREQUENCY_RATIO: f64 = 4.0;

/// Effect of one more experiment on a doubt between causes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Separation {
    /// Lead of the hidden effect before the experiment: criterion of the best other candidate minus
    /// its own.
    pub lead: f64,
    /// After the proposed experiment.
    pub asked_for: Separated,
    /// After a random experiment, at a magnitude within the range of the design and a frequency
    /// from its lowest to four times its highest.
    pub random: Separated,
}

/// State of a doubt after one more experiment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Separated {
    /// Whether the first cause is the hidden effect, without equivalents.
    pub ended: bool,
    /// Lead of the hidden effect.
    pub lead: f64,
}

impl Separation {
    /// Whether the lead is larger after the proposed experiment than after the random one.
    pub fn asked_for_is_better(&self) -> bool {
        self.asked_for.lead > self.random.lead
    }
}

/// Adds the proposed experiment to the measurement of a draw, and separately a random one, with the
/// same noise as the others, and diagnoses both. `None` if no experiment is proposed, or the
/// machine has no periodic response there.
///
/// # Errors
/// See [`MakeError`].
pub(super) fn separate(
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
        let Some(measurement) = with_experiment(made, point, rng)? else { return Ok(None) };
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

/// Lead of the single hidden effect; `None` if it was not tried.
fn lead(made: &Made, candidates: &[Candidate]) -> Option<f64> {
    let all = || candidates.iter();
    let own = all().find(|candidate| made.hides(&candidate.effect))?;
    let others = all().filter(|candidate| !made.hides(&candidate.effect));
    Some(others.map(|other| other.criterion).fold(f64::INFINITY, f64::min) - own.criterion)
}

/// A random magnitude and frequency, log-uniform over the range of a design; frequencies up to
/// [`RANDOM_FREQUENCY_RATIO`] times its highest.
fn random_point(machine: &Draw, rng: &mut ChaCha8Rng) -> (f64, f64) {
    let mut within = |value: fn(&(f64, f64)) -> f64, beyond: f64| {
        let values = || machine.design.iter().map(value);
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        log_uniform(least, beyond * most, rng)
    };
    (within(|point| point.0, 1.0), within(|point| point.1, RANDOM_FREQUENCY_RATIO))
}

/// The measurement with one more experiment at the end of the acquisition.
fn with_experiment(
    made: &Made,
    point: (f64, f64),
    rng: &mut ChaCha8Rng,
) -> Result<Option<Measurement>, MakeError> {
    // The point is simulated as the last of two, so that any drift is at its end.
    let design = made.machine.design.last().copied().into_iter().chain([point]).collect();
    let machine = Draw { design, ..made.machine.clone() };
    let responses = made.instrument.responses(&machine, &Settings::default())?;
    let statement = made.instrument.said.statement();
    let added = responses.experiments_with(&made.noise, statement, rng);
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
    use crate::naming::{Case, build_case};

    #[test]
    fn one_more_experiment_stands_at_the_end_and_is_as_noisy_as_the_others() {
        for key in ["single-50-friction_drift-o0-0", "single-50-gain_asymmetry-o0-4"] {
            let case: Case = key.parse().unwrap();
            let made = build_case(&case, 1, Sizing::Amount, &Silent).unwrap();
            let rng = &mut case.rng(2);
            let (magnitude, omega) = random_point(&made.machine, rng);
            let extended = with_experiment(&made, (magnitude, omega), rng).unwrap().unwrap();
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
