//! Simulated motions of an axis with static friction.

use super::*;
use crate::answers::sample;
use crate::answers::{Diagnosis, Validation, Verdict};
use crate::diagnose::validation::{hurts, validate};
use crate::machines::simulator::{Effect, Machine, Motion, Samples, Settings, Start, follow};
use crate::measurement::{Beginning, Metadata, Transient};
use crate::observer::Silent;
use crate::plant::{Actuator, Friction, Plant};

const STEP_S: f64 = 4e-3;

/// A chirp of 12 s that swells and fades, and the motion of an axis with static friction.
fn moved() -> (Vec<f64>, Motion) {
    let plant = Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let effects = [Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.6)])];
    let at = |t: f64| (0.4 + (0.8 * t).sin().powi(2)) * (t * (3.0 + t)).sin();
    let input: Vec<f64> = (0..=3000).map(|n| at(f64::from(n) * STEP_S)).collect();
    let machine = Machine { plant, effects: &effects };
    let samples = Samples { step_s: STEP_S, values: &input, hold: false };
    let motion = follow(&machine, 0.0, &samples, &Start::default(), &Settings::default());
    (input, motion.unwrap())
}

fn measured(kind: ResponseKind, from: usize, velocity: Option<f64>) -> Measurement {
    let (input, motion) = moved();
    let output = match kind {
        ResponseKind::Velocity => motion.velocity,
        ResponseKind::Position => motion.position,
        ResponseKind::Acceleration => motion.acceleration,
    };
    let transient = Transient {
        step_s: STEP_S,
        input: input[from..].to_vec(),
        output: output[from..].to_vec(),
        beginning: Beginning { velocity, ..Beginning::default() },
        ..Transient::default()
    };
    let metadata = Metadata { response_kind: kind, ..Metadata::default() };
    Measurement::of_transients(metadata, vec![transient], Vec::new(), "m".into()).unwrap()
}

/// A diagnosis with that axis's parameters, but static friction times `factor`.
fn diagnosis(factor: f64) -> Diagnosis {
    let mut answer = sample::explained();
    let base = [("pole", -10.0), ("constant", 10.0), ("fc_plus", 0.5), ("fc_minus", 0.4)];
    let levels = [("fs_plus", 0.8), ("fs_minus", 0.6)];
    let extended = answer.extended.as_mut().unwrap();
    for (name, level) in levels {
        let name = format!("static_friction.{name}");
        extended.parameters[name.as_str()].value = Some(factor * level);
    }
    for (name, value) in base {
        extended.parameters[name].value = Some(value);
        answer.base.parameters[name].value = Some(value);
    }
    answer
}

fn tried(diagnosis: Diagnosis, measurement: &Measurement) -> Validation {
    validate(&Answer::Diagnosis(Box::new(diagnosis)), measurement, &Silent).unwrap()
}

// On such a motion the two simulators agree to 1e-6 of the largest velocity, from which the
// other responses follow.
#[test]
fn the_true_extension_follows_a_motion_from_rest_in_every_response() {
    for kind in [ResponseKind::Velocity, ResponseKind::Position, ResponseKind::Acceleration] {
        let found = tried(diagnosis(1.0), &measured(kind, 0, Some(0.0)));
        let (base, extended) = (&found.models.base, found.models.extended.as_ref().unwrap());
        assert!(extended.nrmse.unwrap() < 1e-4 && base.nrmse.unwrap() > 0.02, "{found:?}");
        assert_eq!((base.components, extended.components), (3001, 3001));
        let gain = found.gain.as_ref().unwrap();
        assert!(gain.interval95[0] > 1.0, "{gain:?}");
        assert_eq!((gain.chi2_per_dof_before, found.verdict), (None, Some(Verdict::Explained)));
        assert!(gain.heldout.contains("12.0000 s, magnitude 1.3975"), "{gain:?}");
        assert!(found.motions[0].beginning_given && found.motions[0].unscored_s == 0.0);
    }
}

#[test]
fn an_extension_that_hurts_on_a_motion_lowers_the_verdict() {
    let found = tried(diagnosis(1.5), &measured(ResponseKind::Velocity, 0, Some(0.0)));
    assert!(hurts(found.gain.as_ref().unwrap()), "{:?}", found.gain);
    assert_eq!(found.verdict, Some(Verdict::Improved));
    assert!(found.remarks[0].contains("makes the prediction worse here"), "{:?}", found.remarks);
}

// The measurement begins where the motion is fast. The first stretch holds 247 exact samples:
// the remaining error is that of the search, which ends at 1e-6 of its cost.
#[test]
fn the_initial_velocity_is_estimated_from_a_first_stretch() {
    let from = 530;
    let (_, motion) = moved();
    let velocity = motion.velocity[from];
    assert!(velocity.abs() > 0.2, "{velocity}");
    for kind in [ResponseKind::Velocity, ResponseKind::Position] {
        let found = tried(diagnosis(1.0), &measured(kind, from, None));
        let extended = found.models.extended.as_ref().unwrap();
        assert!(extended.nrmse.unwrap() < 1e-3, "{found:?}");
        let compared = &found.motions[0];
        let begins = &compared.extended[0];
        assert_eq!((begins.quantity.as_str(), compared.beginning_given), ("velocity", false));
        assert!((begins.value - velocity).abs() < 1e-3 * velocity.abs(), "{compared:?}");
        assert!((compared.unscored_s - 0.1 * compared.duration_s).abs() < 1e-9);
        // 9.88 s without the first tenth, to rounding.
        assert!((2223..=2224).contains(&extended.components), "{extended:?}");
    }
}

#[test]
fn an_axis_at_rest_is_taken_to_begin_at_rest() {
    let found = tried(diagnosis(1.0), &measured(ResponseKind::Velocity, 0, None));
    assert!(found.motions[0].extended.is_empty(), "{:?}", found.motions);
    assert!(found.models.extended.unwrap().nrmse.unwrap() < 1e-4);
}

// The axis has no actuator and sticks; the base model has one that rings, and too little
// friction. Free to start from any torque and any rate of it, it would fit the first stretch.
#[test]
fn errors_of_a_model_are_not_absorbed_by_the_initial_state() {
    let mut diagnosis = diagnosis(1.0);
    for (name, value) in [("natural_frequency", 4.0), ("damping_ratio", 0.1)] {
        let pole = diagnosis.base.parameters["pole"].clone();
        diagnosis.base.parameters.insert(name.into(), pole);
        diagnosis.base.parameters[name].value = Some(value);
    }
    diagnosis.base.parameters["fc_plus"].value = Some(0.3);
    for kind in [ResponseKind::Velocity, ResponseKind::Position] {
        let found = tried(diagnosis.clone(), &measured(kind, 0, None));
        assert!(found.models.base.nrmse.unwrap() > 0.05, "{:?}", found.models);
        assert!(found.motions[0].base.is_empty(), "{:?}", found.motions);
    }
}

#[test]
fn a_fit_refuses_a_motion_and_says_what_to_do() {
    let measurement = measured(ResponseKind::Velocity, 0, None);
    let request = crate::identify::IdentifyRequest::default();
    let error = identify::identify(&measurement, &request, &Silent).unwrap_err().to_string();
    assert!(error.contains("does not repeat") && error.contains("period_s"), "{error}");
    assert!(crate::diagnose::diagnose(&measurement, &request, &Silent).is_err());
}
