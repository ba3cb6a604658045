//! Validation of an answer on motions that do not repeat.
//!
//! Both models simulate every motion. The initial state is given, or each model estimates it from a
//! first stretch that is not compared (`identify::follow`). The residuals are summed over
//! consecutive blocks of time, long enough to be nearly independent. The interval of the gain
//! covers only what happened in the motion: if a few moments decide, as on an axis that seldom
//! sticks, a motion without one gives too small a gain and too short an interval.

use crate::answers::{
    Answer, BeginningValue, Identification, Unanswered, ValidatedModel, ValidatedModels,
    ValidatedMotion,
};
use crate::identify;
use crate::identify::{Begun, Followed, IdentifyError};
use crate::measurement::{Measurement, ResponseKind, after_number};
use crate::observer::Observer;

use super::Outcome;
use super::remarks;
use crate::diagnose::error::ValidateError;
use crate::diagnose::holdout::gain::{ResidualSums, Sample, gain_of_groups, summary_of};

/// Largest number of blocks in all motions together: beyond, Student's t hardly gets smaller.
const MOST_BLOCKS: f64 = 24.0;

/// Shortest duration of a block, in time constants of the mechanics. Tuned.
const BLOCK_TIME_CONSTANTS: f64 = 8.0;

/// The simulation of every motion with one model.
type Simulations = Vec<Result<Followed, Unanswered>>;

/// Tests the models of an answer on the motions of a measurement.
pub(crate) fn tried(
    answer: &Answer,
    measurement: &Measurement,
    observer: &dyn Observer,
) -> Result<Outcome, ValidateError> {
    let transients = measurement.transients().iter();
    let unscored_s: Result<Vec<f64>, IdentifyError> =
        transients.map(|transient| identify::unscored_s(transient, answer.base())).collect();
    let unscored_s = unscored_s?;
    let follow = |model: &Identification| {
        if observer.cancelled() {
            return Err(ValidateError::Cancelled);
        }
        Ok(identify::follow(measurement, model, &unscored_s)?)
    };
    let base = follow(answer.base())?;
    let extended = answer.extended().map(follow).transpose()?;
    let both = |i: usize| {
        base[i].is_ok()
            && extended.as_ref().is_none_or(|extended: &Simulations| extended[i].is_ok())
    };
    let kept: Vec<usize> = (0..base.len()).filter(|i| both(*i)).collect();
    if kept.is_empty() {
        let reasons = base.iter().chain(extended.iter().flatten());
        let mut why =
            reasons.filter_map(|tried| tried.as_ref().err()).map(|lost| lost.reason.clone());
        let reason =
            format!("they can follow none of its motions: {}", why.next_back().unwrap_or_default());
        return Err(ValidateError::Unusable { reason });
    }
    let block_s = block_s(answer.base(), measurement, &kept, &unscored_s);
    let blocks = [Some(&base), extended.as_ref()].map(|model| {
        let model = model?;
        let followed = kept.iter().filter_map(|i| Some((*i, model[*i].as_ref().ok()?)));
        let blocks = followed.map(|(i, followed)| {
            let step_s = measurement.transients()[i].step_s;
            in_blocks(followed, ((block_s / step_s).round() as usize).max(1))
        });
        Some(blocks.flatten().collect::<Vec<ResidualSums>>())
    });
    let [Some(before), after] = blocks else { unreachable!("the base model is tried") };
    let heldout = heldout(measurement, &kept, &unscored_s, before.len(), block_s);
    let pairs = |after: &Vec<ResidualSums>| -> Vec<[ResidualSums; 2]> {
        before.iter().zip(after).map(|(before, after)| [*before, *after]).collect()
    };
    let gain = after
        .as_ref()
        .and_then(|after| gain_of_groups(&pairs(after), Sample::Independent, false, heldout));
    let components = kept.iter().filter_map(|i| base[*i].as_ref().ok()).map(|f| f.measured.len());
    let components: usize = components.sum();
    let model = |blocks: &[ResidualSums], tries: &Simulations| ValidatedModel {
        unanswered: tries.iter().filter_map(|tried| tried.as_ref().err().cloned()).collect(),
        ..summary_of(&ResidualSums::sum(blocks), components, false)
    };
    let motions = motions(measurement, &unscored_s, &base, extended.as_ref());
    let metadata = measurement.metadata();
    Ok(Outcome {
        response_quantity: match metadata.response_kind {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        }
        .into(),
        response_unit: metadata.response.unit.clone(),
        models: ValidatedModels {
            base: model(&before, &base),
            extended: after.as_ref().zip(extended.as_ref()).map(|(left, tries)| model(left, tries)),
        },
        gain,
        noise_known: false,
        remarks: remarks::of_motions(&motions, metadata.response_kind, extended.is_some()),
        motions,
    })
}

/// Duration of a block in seconds.
fn block_s(
    base: &Identification,
    measurement: &Measurement,
    kept: &[usize],
    unscored_s: &[f64],
) -> f64 {
    let compared_s = |i: &usize| measurement.transients()[*i].duration_s() - unscored_s[*i];
    let whole_s: f64 = kept.iter().map(compared_s).sum();
    let rate = base.parameters.get("pole").and_then(|pole| pole.value).map_or(0.0, |pole| -pole);
    let forgets_s = if rate > 0.0 { BLOCK_TIME_CONSTANTS / rate } else { 0.0 };
    // An interval needs two blocks, even if they are too short to be independent.
    (whole_s / MOST_BLOCKS).max(forgets_s).min(0.5 * whole_s)
}

/// Sums over consecutive blocks; a last one shorter than half is joined to the one before.
fn in_blocks(followed: &Followed, samples: usize) -> Vec<ResidualSums> {
    let count = followed.measured.len();
    let blocks = ((count as f64 / samples as f64).round() as usize).max(1);
    let mut left = vec![ResidualSums::default(); blocks];
    for (n, (measured, simulated)) in followed.measured.iter().zip(&followed.simulated).enumerate()
    {
        left[(n / samples).min(blocks - 1)].add_sample(*measured, *simulated);
    }
    left
}

fn motions(
    measurement: &Measurement,
    unscored_s: &[f64],
    base: &Simulations,
    extended: Option<&Simulations>,
) -> Vec<ValidatedMotion> {
    let values = |tried: Option<&Result<Followed, Unanswered>>| {
        let found = tried.and_then(|tried| tried.as_ref().ok()).map(|f| f.beginning.as_slice());
        let value = |begun: &Begun| BeginningValue {
            quantity: begun.quantity.name().into(),
            value: begun.value,
            implausible: begun.implausible.clone(),
        };
        found.unwrap_or_default().iter().map(value).collect()
    };
    let all = measurement.transients().iter().enumerate();
    let motion = |(i, transient): (usize, &crate::measurement::Transient)| ValidatedMotion {
        experiment: i,
        duration_s: transient.duration_s(),
        unscored_s: unscored_s[i],
        beginning_given: transient.beginning.velocity.is_some(),
        base: values(base.get(i)),
        extended: values(extended.and_then(|extended| extended.get(i))),
    };
    all.map(motion).collect()
}

/// What was held out, in words.
fn heldout(
    measurement: &Measurement,
    kept: &[usize],
    unscored_s: &[f64],
    blocks: usize,
    block_s: f64,
) -> String {
    let transients = || kept.iter().map(|i| &measurement.transients()[*i]);
    let whole_s: f64 = transients().map(|transient| transient.duration_s()).sum();
    let unscored_s: f64 = kept.iter().map(|i| unscored_s[*i]).sum();
    let magnitude = transients().map(|transient| transient.magnitude()).fold(0.0, f64::max);
    let unit = after_number(&measurement.metadata().input.unit);
    let motions = match kept.len() {
        1 => "one motion that does not repeat".to_owned(),
        count => format!("{count} motions that do not repeat"),
    };
    let without = if unscored_s > 0.0 {
        format!(" without the first {unscored_s:.4} s")
    } else {
        String::new()
    };
    format!(
        "a second measurement: {motions}, {whole_s:.4} s{without}, magnitude {magnitude:.4}{unit}, \
         in {blocks} blocks of {block_s:.4} s"
    )
}

#[cfg(test)]
mod tests {
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
        assert!(
            found.remarks[0].contains("makes the prediction worse here"),
            "{:?}",
            found.remarks
        );
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
}
