//! A stored answer, tried on another measurement.
//!
//! Nothing is fitted: both models are rebuilt from their reported parameters, simulated on
//! the other measurement's own inputs, and compared with its response as measured.

use crate::answers::{
    Answer, Cause, ComparedExperiment, Comparison, Diagnosis, Gain, Identification, ValidatedCause,
    ValidatedModel, ValidatedModels, ValidatedMotion, Validation, ValidationProvenance, Verdict,
    Weighting,
};
use crate::identify::{self, IdentifyError, IdentifyRequest, UnitAgreement};
use crate::measurement::Measurement;
use crate::observer::Observer;

use super::gain::{gain, summary};
use super::predicted::{Predicted, groups, predicted};
use super::remarks::{self, Tried};
use super::{DiagnoseError, diagnose, motions};

/// Why an answer cannot be tried on a measurement.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValidateError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// It is the one that was fitted.
    #[error(
        "it has the same data as the measurement that is fitted: what is gained on them proves \
         nothing; give another measurement of the same axis"
    )]
    SameData,
    /// Its units contradict those of the parameters.
    #[error(
        "its {quantity} is in {here}, the parameters are for {fitted}: give both measurements in \
         the same units"
    )]
    Units {
        /// `input` or `velocity`.
        quantity: &'static str,
        /// Unit that was fitted in.
        fitted: String,
        /// Unit of the other measurement.
        here: String,
    },
    /// No model can be simulated on it.
    #[error("the models cannot be tried on it: {reason}")]
    Unusable {
        /// What is missing.
        reason: String,
    },
}

impl From<IdentifyError> for ValidateError {
    fn from(error: IdentifyError) -> Self {
        match error {
            IdentifyError::Cancelled => Self::Cancelled,
            IdentifyError::Unusable { reason } => Self::Unusable { reason },
            IdentifyError::Options(invalid) => Self::Unusable { reason: invalid.to_string() },
        }
    }
}

/// Tries the models of an answer on another measurement.
///
/// What one of them has no response for counts for neither.
///
/// # Errors
/// See [`ValidateError`].
pub fn validate(
    answer: &Answer,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Validation, ValidateError> {
    let agreement = UnitAgreement::with_answer(answer.base(), measurement);
    let agreement = without_contradiction(agreement)?;
    if !measurement.transients().is_empty() {
        let outcome = motions::tried(answer, measurement, observer)?;
        return Ok(concluded(answer, measurement, &agreement, outcome));
    }
    let base = simulated(answer.base(), measurement, observer)?;
    let extended = answer.extended().map(|model| simulated(model, measurement, observer));
    compared(answer, measurement, &agreement, &base, extended.transpose()?.as_ref())
}

/// What the models of an answer come to on other data.
pub(super) struct Outcome {
    pub response_quantity: String,
    pub response_unit: String,
    pub models: ValidatedModels,
    pub gain: Option<Gain>,
    pub noise_known: bool,
    pub motions: Vec<ValidatedMotion>,
    /// What is to be minded of how they were compared.
    pub remarks: Vec<String>,
}

/// What the models of an answer come to, both beside the measurement.
fn compared(
    answer: &Answer,
    measurement: &Measurement,
    agreement: &UnitAgreement,
    base: &Comparison,
    extended: Option<&Comparison>,
) -> Result<Validation, ValidateError> {
    let mut kept = predicted(base);
    let mut after = extended.map(predicted);
    if let Some(after) = &mut after {
        kept.retain(|row, _| after.contains_key(row));
        after.retain(|row, _| kept.contains_key(row));
    }
    if kept.is_empty() {
        let reason = "they have no response to any of its experiments".into();
        return Err(ValidateError::Unusable { reason });
    }
    let experiments: Vec<&ComparedExperiment> = base
        .experiments
        .iter()
        .filter(|e| kept.range((e.experiment, 0)..=(e.experiment, usize::MAX)).next().is_some())
        .collect();
    let groups = groups(&experiments);
    let noise_known = !base.std_estimated;
    let gain = after.as_ref().and_then(|after| {
        gain(&kept, after, &groups, noise_known, remarks::heldout(base, &experiments))
    });
    let model = |predicted: &Predicted, comparison: &Comparison| ValidatedModel {
        unanswered: comparison.unanswered.clone(),
        ..summary(predicted, noise_known)
    };
    let outcome = Outcome {
        response_quantity: base.response_quantity.clone(),
        response_unit: base.response_unit.clone(),
        models: ValidatedModels {
            base: model(&kept, base),
            extended: after.as_ref().zip(extended).map(|(p, c)| model(p, c)),
        },
        gain,
        noise_known,
        motions: Vec::new(),
        remarks: Vec::new(),
    };
    Ok(concluded(answer, measurement, agreement, outcome))
}

/// The validation that an outcome makes, and what it does to the verdict.
fn concluded(
    answer: &Answer,
    measurement: &Measurement,
    agreement: &UnitAgreement,
    outcome: Outcome,
) -> Validation {
    let Outcome { models, gain, noise_known, .. } = outcome;
    let verdict = answer.verdict().map(|verdict| {
        // A diagnosis that was validated on these data has taken the step already.
        let validated = match answer {
            Answer::Diagnosis(diagnosis) => diagnosis.validation.as_ref(),
            Answer::Identification(_) => None,
        };
        let taken = validated.is_some_and(|v| v.data_sha256 == measurement.sha256());
        let lower = !taken && gain.as_ref().is_some_and(hurts);
        if lower { lowered(verdict) } else { verdict }
    });
    let tried = Tried {
        causes: answer.causes(),
        models: &models,
        gain: gain.as_ref(),
        verdicts: answer.verdict().zip(verdict),
        noise_known,
    };
    let mut said = tried.remarks();
    said.extend(outcome.remarks);
    said.extend(remarks::of_data(answer, measurement, agreement));
    Validation {
        data_sha256: measurement.sha256().to_owned(),
        response_quantity: outcome.response_quantity,
        response_unit: outcome.response_unit,
        motions: outcome.motions,
        causes: causes(answer.causes(), gain.as_ref()),
        models,
        gain,
        verdict,
        remarks: said,
        provenance: provenance(answer.base(), measurement),
    }
}

/// [`diagnose`], and the gain measured on a second measurement. Where the causes hurt there,
/// the verdict is a step lower.
///
/// # Errors
/// See [`DiagnoseError`]; a second measurement that cannot be used is refused before anything
/// is computed.
pub fn diagnose_validated(
    measurement: &Measurement,
    second: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    without_contradiction(UnitAgreement::between(measurement, second))?;
    if !second.sha256().is_empty() && second.sha256() == measurement.sha256() {
        return Err(ValidateError::SameData.into());
    }
    let answer = diagnose(measurement, request, observer)?;
    validated(answer, second, observer)
}

/// A diagnosis with what a second measurement says of it.
fn validated(
    diagnosis: Diagnosis,
    second: &Measurement,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let answer = Answer::Diagnosis(Box::new(diagnosis));
    let validation = validate(&answer, second, observer);
    let Answer::Diagnosis(answer) = answer else { unreachable!("it is a diagnosis") };
    let mut answer = *answer;
    match validation {
        Ok(validation) => {
            if let Some(gain) = &validation.gain {
                if hurts(gain) {
                    answer.limitations.extend(validation.remarks.first().cloned());
                }
                answer.gain = Some(gain.clone());
            }
            for (cause, here) in answer.causes.iter_mut().zip(&validation.causes) {
                cause.gain = here.gain.clone().or(cause.gain.take());
            }
            answer.verdict = validation.verdict.unwrap_or(answer.verdict);
            answer.validation = Some(validation);
        }
        Err(ValidateError::Cancelled) => return Err(IdentifyError::Cancelled.into()),
        // What was computed from the first measurement stands.
        Err(error) => answer.limitations.push(format!("the second measurement is unused: {error}")),
    }
    Ok(answer)
}

fn without_contradiction(agreement: UnitAgreement) -> Result<UnitAgreement, ValidateError> {
    match agreement {
        UnitAgreement::Different { quantity, fitted, here } => {
            Err(ValidateError::Units { quantity, fitted, here })
        }
        agreement => Ok(agreement),
    }
}

/// A model beside the measurement, whose noise is what the measurement itself says of it: the
/// option `noise_std` is of the data that were fitted, and in the units of their response, and
/// how these were weighed says nothing of how well a model predicts.
fn simulated(
    model: &Identification,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Comparison, ValidateError> {
    if observer.cancelled() {
        return Err(ValidateError::Cancelled);
    }
    let mut model = model.clone();
    model.provenance.options.noise_std = None;
    model.provenance.options.weights = Weighting::Noise;
    Ok(identify::compare(measurement, &model)?)
}

/// What the model with one cause alone gains; that is the extended model where there is one.
fn causes(causes: &[Cause], gain: Option<&Gain>) -> Vec<ValidatedCause> {
    let alone = gain.filter(|_| causes.len() == 1);
    let cause =
        |cause: &Cause| ValidatedCause { effect: cause.effect.clone(), gain: alone.cloned() };
    causes.iter().map(cause).collect()
}

/// Whether the extension predicts worse beyond doubt.
pub(super) fn hurts(gain: &Gain) -> bool {
    gain.interval95[1] < 1.0
}

fn lowered(verdict: Verdict) -> Verdict {
    match verdict {
        Verdict::Explained => Verdict::Improved,
        Verdict::Improved | Verdict::Unexplained => Verdict::Unexplained,
        Verdict::Adequate => Verdict::Adequate,
    }
}

fn provenance(fitted: &Identification, measurement: &Measurement) -> ValidationProvenance {
    ValidationProvenance {
        software_version: env!("CARGO_PKG_VERSION").to_owned(),
        fitted_data_sha256: fitted.provenance.data_sha256.clone(),
        validation_data_sha256: measurement.sha256().to_owned(),
        fitted_by_version: fitted.provenance.software_version.clone(),
        options: fitted.provenance.options,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::draw::{Draw, draw};
    use crate::benchmark::responses::Responses;
    use crate::benchmark::simulator::{Effect, Settings};
    use crate::measurement::{Metadata, Quantity};
    use crate::observer::Silent;
    use crate::plant::{Actuator, Friction, Plant};
    use crate::report::sample;

    /// Standard deviation that the measurement tells.
    const STD: f64 = 1e-3;

    /// An axis with static friction, without noise: 2 magnitudes, 6 frequencies.
    fn measurement(std: Option<f64>) -> Measurement {
        let plant = Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(0.5, 0.4),
        };
        let design = [1.2, 2.5].into_iter();
        let design = design.flat_map(|m| [1.0, 2.0, 4.0, 8.0, 16.0, 32.0].map(|omega| (m, omega)));
        let draw = Draw {
            plant,
            effects: vec![Effect::StaticFriction { fs_plus: 0.8, fs_minus: 0.6 }],
            design: design.collect(),
            harmonics: 5,
            noise_db: None,
            ..draw(0, 1)
        };
        let responses = Responses::simulate(&draw, &Settings::default()).unwrap();
        responses.exact(std).unwrap()
    }

    /// The diagnosis of it, static friction as it is times `factor`.
    fn diagnosis(factor: f64) -> Diagnosis {
        let mut answer = sample::explained();
        let set = |model: &mut Identification, values: &[(&str, f64)]| {
            for (name, value) in values {
                model.parameters[*name].value = Some(*value);
            }
        };
        let base = [("pole", -10.0), ("constant", 10.0), ("fc_plus", 0.5), ("fc_minus", 0.4)];
        set(&mut answer.base, &base);
        let extended = answer.extended.as_mut().unwrap();
        set(extended, &base);
        let levels = [("fs_plus", 0.8), ("fs_minus", 0.6)];
        let levels = levels.map(|(name, level)| (format!("static_friction.{name}"), level));
        for (name, level) in levels {
            set(extended, &[(name.as_str(), factor * level)]);
        }
        answer
    }

    fn tried(diagnosis: Diagnosis, measurement: &Measurement) -> Validation {
        let answer = Answer::Diagnosis(Box::new(diagnosis));
        validate(&answer, measurement, &Silent).unwrap()
    }

    // The two simulators agree to 3e-6 of the largest response, which is 1 in 2.5 here.
    #[test]
    fn the_true_extension_leaves_nothing_and_the_base_model_what_it_misses() {
        let found = tried(diagnosis(1.0), &measurement(Some(STD)));
        let (base, extended) = (&found.models.base, found.models.extended.as_ref().unwrap());
        assert!(extended.nrmse.unwrap() < 1e-5 && base.nrmse.unwrap() > 1e-3, "{found:?}");
        // 12 experiments, harmonics 0 to 5.
        assert_eq!((base.components, extended.components), (72, 72));
        // χ² is of re and im, of a mean of re alone.
        let chi2 = base.rms.powi(2) * 72.0 / STD.powi(2) / (12.0 * 11.0);
        assert!((base.chi2_per_dof.unwrap() / chi2 - 1.0).abs() < 1e-9, "{found:?}");
        let gain = found.gain.as_ref().unwrap();
        assert!(gain.interval95[0] > 1.0, "{gain:?}");
        assert_eq!(found.causes[0].gain.as_ref(), Some(gain));
        assert_eq!(found.verdict, Some(Verdict::Explained));
        assert!(gain.heldout.starts_with("a second measurement: 12 experiments, magnitude 1.2"));
        assert!(found.remarks[0].starts_with("static_friction helps here, too"), "{found:?}");
    }

    #[test]
    fn an_extension_that_hurts_lowers_the_verdict_by_one_step_and_says_so() {
        let measurement = measurement(Some(STD));
        let wrong = diagnosis(1.45);
        let found = tried(wrong.clone(), &measurement);
        assert!(hurts(found.gain.as_ref().unwrap()), "{:?}", found.gain);
        assert_eq!(found.verdict, Some(Verdict::Improved));
        let said = &found.remarks[0];
        assert!(said.contains("helps on the fitted data and hurts here"), "{said}");
        assert!(said.ends_with("the verdict is IMPROVED instead of EXPLAINED"), "{said}");
        let improved = Diagnosis { verdict: Verdict::Improved, ..wrong.clone() };
        assert_eq!(tried(improved, &measurement).verdict, Some(Verdict::Unexplained));

        let answer = validated(wrong, &measurement, &Silent).unwrap();
        assert_eq!(answer.verdict, Verdict::Improved);
        assert_eq!(answer.gain, found.gain);
        assert_eq!(answer.limitations.last(), Some(said));
        // The step was taken: the same data take no second one.
        assert_eq!(tried(answer, &measurement).verdict, Some(Verdict::Improved));
    }

    #[test]
    fn what_one_model_has_no_response_for_counts_for_neither() {
        let answer = Answer::Diagnosis(Box::new(diagnosis(1.0)));
        let base = sample::comparison();
        let mut extended = base.clone();
        let lost = extended.experiments.remove(2).experiment;
        let reason = "it never settles".to_owned();
        extended.unanswered.push(crate::answers::Unanswered { experiment: lost, reason });
        let same = UnitAgreement::Same;
        let measurement = measurement(None);
        let found = compared(&answer, &measurement, &same, &base, Some(&extended)).unwrap();
        let [of_base, of_extended] = [&found.models.base, found.models.extended.as_ref().unwrap()];
        // 17 of 18 experiments, harmonics 0 to 3.
        assert_eq!((of_base.components, of_extended.components), (68, 68));
        assert_eq!((of_base.unanswered.len(), of_extended.unanswered.len()), (0, 1));
        let said = found.remarks.iter().find(|text| text.contains("no response")).unwrap();
        assert!(said.starts_with("the extended model has no response to 1 experiment"), "{said}");
        let nothing = Comparison { experiments: Vec::new(), ..base.clone() };
        let error = compared(&answer, &measurement, &same, &base, Some(&nothing)).unwrap_err();
        assert!(error.to_string().contains("no response to any"), "{error}");
    }

    #[test]
    fn the_noise_is_what_the_measurement_says_of_it() {
        let mut answer = diagnosis(1.0);
        answer.base.provenance.options.noise_std = Some(STD);
        let found = tried(answer, &measurement(None));
        assert_eq!(found.models.base.chi2_per_dof, None);
        assert!(found.remarks.iter().any(|text| text.contains("how noisy")), "{found:?}");
        assert_eq!(found.provenance.options.noise_std, Some(STD));
    }

    #[test]
    fn an_identification_has_no_verdict_and_no_gain() {
        let answer = Answer::Identification(Box::new(diagnosis(1.0).base));
        let found = validate(&answer, &measurement(None), &Silent).unwrap();
        assert_eq!((found.verdict, &found.gain, &found.models.extended), (None, &None, &None));
        assert!(found.causes.is_empty() && found.remarks[0].contains("no cause is named"));
    }

    #[test]
    fn units_that_contradict_are_refused_and_a_missing_parameter_by_its_name() {
        let unit = |unit: &str| Quantity { name: String::new(), unit: unit.into() };
        let metadata = Metadata { input: unit("V"), ..Metadata::default() };
        let in_volts = measurement(None).experiments().to_vec();
        let in_volts = Measurement::new(metadata, in_volts, Vec::new(), "v".into()).unwrap();
        let answer = Answer::Diagnosis(Box::new(diagnosis(1.0)));
        let error = validate(&answer, &in_volts, &Silent).unwrap_err().to_string();
        assert!(error.contains("its input is in V, the parameters are for A"), "{error}");

        let without = Answer::Diagnosis(Box::new(sample::explained()));
        let error = validate(&without, &measurement(None), &Silent).unwrap_err().to_string();
        assert!(error.contains("no value of fc_minus"), "{error}");
        let kept = validated(sample::explained(), &measurement(None), &Silent).unwrap();
        assert_eq!((kept.verdict, kept.validation), (Verdict::Explained, None));
        assert!(kept.limitations[0].starts_with("the second measurement is unused: "));
    }

    #[test]
    fn a_second_measurement_that_cannot_serve_is_refused_before_anything_is_fitted() {
        let experiments = measurement(None).experiments().to_vec();
        let with = |sha256: &str, unit: &str| {
            let input = Quantity { name: String::new(), unit: unit.into() };
            let metadata = Metadata { input, ..Metadata::default() };
            Measurement::new(metadata, experiments.clone(), Vec::new(), sha256.into()).unwrap()
        };
        struct Nobody;
        impl Observer for Nobody {
            fn cancelled(&self) -> bool {
                panic!("something is computed")
            }
        }
        let refused = |second: &Measurement| {
            let request = IdentifyRequest::default();
            diagnose_validated(&with("a", "A"), second, &request, &Nobody).unwrap_err()
        };
        assert_eq!(refused(&with("a", "A")), ValidateError::SameData.into());
        let quantity = "input";
        let units = ValidateError::Units { quantity, fitted: "A".into(), here: "V".into() };
        assert_eq!(refused(&with("b", "V")), units.into());
    }
}
