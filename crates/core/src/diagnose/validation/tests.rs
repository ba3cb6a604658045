use super::*;
use crate::answers::sample;
use crate::machines::draw::{Draw, draw};
use crate::machines::responses::Responses;
use crate::machines::simulator::{Effect, Settings};
use crate::measurement::{Metadata, Quantity};
use crate::observer::Silent;
use crate::plant::{Actuator, Friction, Plant};

/// Standard deviation that the measurement states.
const STD: f64 = 1e-3;

/// A noise-free measurement of an axis with static friction: 2 magnitudes, 6 frequencies.
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
        effects: vec![Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.6)])],
        design: design.collect(),
        harmonics: 5,
        noise_db: None,
        ..draw(0, 1)
    };
    let responses = Responses::simulate(&draw, &Settings::default()).unwrap();
    responses.exact(std).unwrap()
}

/// A diagnosis with that axis's parameters, but static friction times `factor`.
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

// The two simulators agree to 3e-6 of the largest response.
#[test]
fn the_true_extension_leaves_nothing_and_the_base_model_what_it_misses() {
    let found = tried(diagnosis(1.0), &measurement(Some(STD)));
    let (base, extended) = (&found.models.base, found.models.extended.as_ref().unwrap());
    assert!(extended.nrmse.unwrap() < 1e-5 && base.nrmse.unwrap() > 1e-3, "{found:?}");
    // 12 experiments, harmonics 0 to 5.
    assert_eq!((base.components, extended.components), (72, 72));
    // χ² counts re and im, of the mean re alone.
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
    assert!(
        said.contains("helps on the fitted data and makes the prediction worse here"),
        "{said}"
    );
    assert!(said.ends_with("the verdict is therefore IMPROVED instead of EXPLAINED"), "{said}");
    let improved = Diagnosis { verdict: Verdict::Improved, ..wrong.clone() };
    assert_eq!(tried(improved, &measurement).verdict, Some(Verdict::Unexplained));

    let answer = validated(wrong, &measurement, &Silent).unwrap();
    assert_eq!(answer.verdict, Verdict::Improved);
    assert_eq!(answer.gain, found.gain);
    assert_eq!(answer.limitations.last(), Some(said));
    // The verdict was lowered already; the same data do not lower it again.
    assert_eq!(tried(answer, &measurement).verdict, Some(Verdict::Improved));
}

#[test]
fn an_experiment_in_which_one_model_has_no_response_counts_for_neither() {
    let answer = Answer::Diagnosis(Box::new(diagnosis(1.0)));
    let base = sample::comparison();
    let mut extended = base.clone();
    let lost = extended.experiments.remove(2).experiment;
    let reason = "it never settles".to_owned();
    extended.unanswered.push(crate::answers::Unanswered {
        experiment: lost,
        magnitude: Some(1.0),
        omega_rad_s: Some(2.0),
        reason,
    });
    let same = UnitCompatibility::Same;
    let measurement = measurement(None);
    let found = compared(&answer, &measurement, &same, &base, Some(&extended)).unwrap();
    let [of_base, of_extended] = [&found.models.base, found.models.extended.as_ref().unwrap()];
    // 17 of 18 experiments, harmonics 0 to 3.
    assert_eq!((of_base.components, of_extended.components), (68, 68));
    assert_eq!((of_base.unanswered.len(), of_extended.unanswered.len()), (0, 1));
    let said = found.remarks.iter().find(|text| text.contains("no response")).unwrap();
    assert!(
        said.starts_with("the model with the causes has no response to 1 experiment"),
        "{said}"
    );
    let nothing = Comparison { experiments: Vec::new(), ..base.clone() };
    let error = compared(&answer, &measurement, &same, &base, Some(&nothing)).unwrap_err();
    assert!(error.to_string().contains("no response to any"), "{error}");
}

#[test]
fn the_noise_is_what_the_validation_measurement_states() {
    let mut answer = diagnosis(1.0);
    answer.base.provenance.options.noise_std = Some(STD);
    let found = tried(answer, &measurement(None));
    assert_eq!(found.models.base.chi2_per_dof, None);
    assert!(
        found.remarks.iter().any(|text| text.contains("does not state its noise")),
        "{found:?}"
    );
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
fn an_unusable_second_measurement_is_refused_before_anything_is_fitted() {
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
