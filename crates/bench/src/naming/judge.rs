//! Compares a diagnosis with the true hidden effects.

use std::f64::consts::TAU;

use indexmap::IndexMap;
use serde::Serialize;
use servoscope_core::answers::{Diagnosis, FaultKind, ParameterEstimate, Verdict};

use super::build_case::{Hidden, Made};
use super::case::{Case, Kind};
use super::dominance::Dominance;
use super::fresh::Fresh;
use super::instrument::Instrument;
use super::mismeasured::Mismeasured;
use super::rivals::Nearest;
use super::separation::Separation;

/// A draw, the answer to it, and the time it took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The key of the draw.
    pub key: String,
    /// Kind of draw.
    pub kind: Kind,
    /// Noise, dB.
    pub level_db: u32,
    /// True order of the actuator.
    pub order: u8,
    /// How the machine was measured.
    pub instrument: Instrument,
    /// Excess of the base model of the true order; 0 if nothing is hidden.
    pub excess: f64,
    /// What the dominant effects make and leave of it; null if there are no small ones beside them.
    pub dominance: Option<Dominance>,
    /// The hidden effects.
    pub hidden: Vec<Hidden>,
    /// The answer, or the error of the diagnosis.
    pub answer: Result<Answer, String>,
    /// The fault of the measurement, and what the answer says of it; null if it has none.
    pub mismeasurement: Option<Mismeasured>,
    /// The answer to the same measurement without its fault, or the error of that diagnosis; null
    /// if that was not diagnosed.
    pub sound: Option<Result<Answer, String>>,
    /// Whether the next experiment distinguished the hidden effect from its rivals; null if that
    /// was not tried.
    pub separation: Option<Separation>,
    /// The effect of the library that imitates a single hidden one best; null if that was not
    /// requested.
    pub nearest: Option<Nearest>,
    /// The reported gain and that on a fresh measurement; null if no gain is reported.
    pub fresh: Option<Fresh>,
    /// Computing times.
    pub seconds: Seconds,
}

/// Wall-clock seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Seconds {
    /// To draw the machine and simulate it.
    pub data: f64,
    /// To diagnose it.
    pub job: f64,
}

/// The part of a diagnosis that is judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The verdict.
    pub verdict: Verdict,
    /// Causes, strongest first.
    pub causes: Vec<Named>,
    /// Parameters of the hidden effects that are named.
    pub effect_parameters: Vec<Estimated>,
    /// Parameters of the plant, from the model with the causes or, if none is named, the base
    /// model.
    pub plant_parameters: Vec<Estimated>,
    /// The faults of the measurement that are named.
    pub faults: Vec<FaultKind>,
}

/// A named cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Named {
    /// Id of the effect.
    pub effect: String,
    /// Its confidence.
    pub confidence: f64,
    /// By which factor the best model without it leaves more; null if that is not known.
    pub margin: Option<f64>,
    /// Effects that the data cannot distinguish from it.
    pub equivalents: Vec<String>,
    /// Values of its parameters.
    pub parameters: IndexMap<String, Option<f64>>,
}

/// A parameter with its true value and its estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimated {
    /// The effect it belongs to, or `plant`.
    pub of: String,
    /// Its name.
    pub name: String,
    /// Its true value.
    pub truth: f64,
    /// The estimate's 95 % interval; null if it is reported as not identifiable.
    pub interval95: Option<[f64; 2]>,
}

impl Estimated {
    fn new(of: &str, name: &str, truth: f64, estimate: Option<&ParameterEstimate>) -> Self {
        let interval95 = estimate.and_then(|estimate| estimate.interval95);
        Self { of: of.to_owned(), name: name.to_owned(), truth, interval95 }
    }

    /// Whether the interval contains the true value (of a phase, any value that differs by whole
    /// turns); `None` without an interval.
    pub fn held(&self) -> Option<bool> {
        self.interval95.map(|[low, high]| {
            let truth = match self.name.as_str() {
                // Shifted by whole turns to the lowest value that is not below the interval.
                "phase" => self.truth + TAU * ((low - self.truth) / TAU).ceil(),
                _ => self.truth,
            };
            (low..=high).contains(&truth)
        })
    }
}

impl Outcome {
    /// Compares the answer to a draw with the truth.
    pub fn new(
        case: &Case,
        made: &Made,
        answer: Result<&Diagnosis, String>,
        seconds: Seconds,
    ) -> Self {
        let faults = answer.as_ref().map_or(&[][..], |diagnosis| &diagnosis.measurement);
        Self {
            key: case.to_string(),
            kind: case.kind,
            level_db: case.level_db,
            order: case.order,
            instrument: made.instrument,
            excess: made.excess,
            dominance: made.dominance.clone(),
            hidden: made.hidden.clone(),
            mismeasurement: made.mistake.as_ref().map(|mistake| Mismeasured::of(mistake, faults)),
            answer: answer.map(|diagnosis| Answer::of(diagnosis, made)),
            sound: None,
            separation: None,
            nearest: None,
            fresh: None,
            seconds,
        }
    }
}

impl Answer {
    /// The part of a diagnosis that is judged, with the true values of this draw.
    pub(super) fn of(diagnosis: &Diagnosis, made: &Made) -> Self {
        let named = diagnosis.causes.iter().map(|cause| Named {
            effect: cause.effect.clone(),
            confidence: cause.confidence,
            margin: cause.margin,
            equivalents: cause.equivalents.clone(),
            parameters: cause.parameters.iter().map(|(name, p)| (name.clone(), p.value)).collect(),
        });
        let effect_parameters = made.hidden.iter().flat_map(|hidden| {
            let causes = diagnosis.causes.iter().filter(|cause| cause.effect == hidden.effect);
            causes.flat_map(|cause| {
                hidden.parameters.iter().map(|(name, truth)| {
                    Estimated::new(hidden.effect, name, *truth, cause.parameters.get(*name))
                })
            })
        });
        let model = diagnosis.extended.as_ref().unwrap_or(&diagnosis.base);
        let of_plant = |(name, truth): (&&str, &f64)| {
            Estimated::new("plant", name, *truth, model.parameters.get(*name))
        };
        Self {
            verdict: diagnosis.verdict,
            causes: named.collect(),
            effect_parameters: effect_parameters.collect(),
            plant_parameters: made.plant.iter().map(of_plant).collect(),
            faults: diagnosis.measurement.iter().map(|found| found.fault).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cause, diagnosis, made};
    use super::*;

    #[test]
    fn parameters_are_compared_where_their_effect_is_named_and_a_phase_in_any_turn() {
        let made = made(&"single-60-cogging-o0-0".parse().unwrap(), &["cogging"]);
        let mut answer = diagnosis(Verdict::Explained);
        let mut named = cause("cogging", 0.99, &[]);
        let estimate = |low: f64, high: f64| ParameterEstimate {
            value: Some(0.5 * (low + high)),
            std: Some(0.25 * (high - low)),
            interval95: Some([low, high]),
            unit: String::new(),
            at_bound: false,
            identifiable: true,
        };
        // All parameters of the hidden effects are 1 in the fixture.
        named.parameters.insert("amplitude".into(), estimate(0.9, 1.2));
        named.parameters.insert("cycles_per_unit".into(), estimate(1.1, 1.2));
        named.parameters.insert("phase".into(), estimate(0.9 - TAU, 1.1 - TAU));
        answer.causes.push(named);
        answer.causes.push(cause("spring", 0.9, &[]));
        let compared = Answer::of(&answer, &made).effect_parameters;
        let held: Vec<_> = compared.iter().map(|p| (p.name.as_str(), p.held())).collect();
        let expected =
            [("amplitude", Some(true)), ("cycles_per_unit", Some(false)), ("phase", Some(true))];
        assert_eq!(held, expected);
        answer.causes[0].parameters.clear();
        let compared = Answer::of(&answer, &made).effect_parameters;
        assert!(compared.iter().all(|parameter| parameter.held().is_none()));
    }
}
