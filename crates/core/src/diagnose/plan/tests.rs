//! Plans keep within what is asked, are better than sweeps, and their excitations are read again.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use super::*;
use crate::answers::{PlanOptions, PlannedExperiment, RoughAxis};
use crate::measurement::Measurement;
use crate::measurement::formats::{Source, read};
use crate::observer::Silent;

/// Noise that leaves several effects in doubt: some 2 % of the response after one second.
const NOISE_STD: f64 = 0.02;

/// The first system of the paper: a = 10 1/s.
fn axis() -> RoughAxis {
    RoughAxis {
        pole: -10.0,
        constant: 10.0,
        fc_plus: 0.5,
        fc_minus: 0.4,
        actuator_pole: None,
        natural_frequency: None,
        damping_ratio: None,
    }
}

fn request(budget_s: f64) -> PlanRequest {
    let options = PlanOptions { noise_std: Some(NOISE_STD), ..PlanOptions::default() };
    PlanRequest { axis: axis(), budget_s, options }
}

fn planned(request: &PlanRequest) -> Plan {
    plan(request, &Silent).unwrap()
}

fn refused(change: impl Fn(&mut PlanRequest)) -> String {
    let mut request = request(60.0);
    change(&mut request);
    plan(&request, &Silent).unwrap_err().to_string()
}

/// A plan that several tests look at: 80 s are 800 times 1/a.
fn usual() -> &'static Plan {
    static PLAN: OnceLock<Plan> = OnceLock::new();
    PLAN.get_or_init(|| planned(&request(80.0)))
}

fn probability(plan: &Plan, effect: &str) -> f64 {
    plan.effects.iter().find(|found| found.effect == effect).unwrap().probability
}

#[test]
fn a_plan_keeps_within_budget_and_limits() {
    let plan = usual();
    let sum: f64 = plan.experiments.iter().map(|experiment| experiment.duration_s).sum();
    assert!(plan.duration_s <= 80.0 && (plan.duration_s - sum).abs() < 1e-9);
    // What is left would not pay for the shortest repeat.
    assert!(plan.duration_s > 75.0, "{}", plan.duration_s);
    for (run, experiment) in plan.experiments.iter().enumerate() {
        let PlannedExperiment { magnitude, omega_rad_s, repeats, .. } = *experiment;
        assert_eq!(experiment.run, run);
        assert!((0.7 - 1e-9..=4.0 + 1e-9).contains(&magnitude), "{magnitude}");
        // Periods are rounded to samples: by half a sample of a hundred at most.
        assert!((1.49..=100.5).contains(&omega_rad_s), "{omega_rad_s}");
        assert!(repeats >= 2 && experiment.measured_periods >= 1);
        let periods = experiment.settle_periods + repeats * experiment.measured_periods;
        let duration_s = periods as f64 * TAU / omega_rad_s;
        assert!((experiment.duration_s / duration_s - 1.0).abs() < 1e-9);
        // Seven time constants of the slowest axis that is thought of.
        let settle_s = experiment.settle_periods as f64 * TAU / omega_rad_s;
        assert!(settle_s >= 0.7, "{settle_s}");
    }
    for sweep in &plan.sweeps {
        assert!((75.0..=80.0).contains(&sweep.duration_s), "{}", sweep.duration_s);
    }
}

#[test]
fn a_plan_is_better_than_sweeps_of_the_same_duration_by_its_own_criterion() {
    let plan = usual();
    assert_eq!(plan.sweeps.len(), 2);
    let [one, three] = [&plan.sweeps[0], &plan.sweeps[1]];
    assert_eq!((one.magnitudes.len(), three.magnitudes.len()), (1, 3));
    // Enough points to hold some out; then some are repeated more often than they must be.
    assert!(plan.experiments.len() >= 12);
    assert!(plan.experiments.iter().any(|experiment| experiment.repeats > 2));
    let scores = [plan.score, three.score, one.score];
    assert!(plan.score > three.score.max(one.score), "{scores:?}");
    assert!(plan.nameable >= three.nameable);
}

#[test]
fn what_a_plan_says_of_effects_is_what_they_are_known_for() {
    let plan = usual();
    let of = |id: &str| plan.effects.iter().find(|effect| effect.effect == id).unwrap();
    // In the fundamental they are the same (docs/effects.md).
    assert_eq!(of("sensor_lag").closest_imitator.as_deref(), Some("transport_delay"));
    assert!(probability(plan, "gain_asymmetry") > 0.9);
    for effect in &plan.effects {
        let change = |size: &Option<crate::answers::EffectSize>| size.as_ref().map(|s| s.change);
        if let (Some(noticed), Some(named)) =
            (change(&effect.noticed_from), change(&effect.named_from))
        {
            assert!(named >= noticed * (1.0 - 1e-9), "{}", effect.effect);
        }
        assert!((0.0..=1.0).contains(&effect.probability));
    }
    assert!(plan.experiments.iter().any(|experiment| experiment.serves.is_some()));
}

#[test]
fn the_same_seed_gives_the_same_plan() {
    assert_eq!(&planned(&request(80.0)), usual());
}

#[test]
fn with_more_time_no_fewer_effects_are_nameable() {
    let nameable = |budget_s: f64| planned(&request(budget_s)).nameable;
    let found = [nameable(20.0), usual().nameable, nameable(240.0)];
    assert!(found.is_sorted() && found[2] > found[0], "{found:?}");
}

#[test]
fn the_axis_stays_within_its_velocity_and_travel() {
    let mut request = request(20.0);
    request.options.largest_velocity = Some(1.0);
    request.options.largest_travel = Some(0.1);
    let plan = planned(&request);
    let plant = setting::Setting::of(&request).unwrap().plant;
    for experiment in &plan.experiments {
        let PlannedExperiment { magnitude, omega_rad_s, .. } = *experiment;
        let excitation = crate::simulate::Excitation::cosine(omega_rad_s, magnitude);
        let velocity = crate::simulate::respond(&plant, &[], &excitation, 7).unwrap();
        assert!(velocity[1].norm() <= 1.0 && velocity[1].norm() / omega_rad_s <= 0.1);
    }
    request.options.largest_travel = Some(1e-6);
    let refused = super::plan(&request, &Silent).unwrap_err().to_string();
    assert!(refused.contains("largest_travel"), "{refused}");
}

#[test]
fn what_makes_no_sense_is_refused_with_what_to_do() {
    for (change, words) in [
        ((|r| r.axis.pole = 10.0) as fn(&mut PlanRequest), "not negative"),
        (|r| r.axis.constant = 0.0, "does not move"),
        (|r| r.axis.fc_minus = -0.4, "sizes"),
        (|r| r.axis.fc_minus = 1.2e308, "from 0 to 1e100"),
        (|r| r.axis.natural_frequency = Some(30.0), "`damping_ratio`"),
        (|r| r.budget_s = f64::NAN, "not a positive number"),
        (|r| r.budget_s = 1e9, "give less"),
        (|r| r.budget_s = 0.5, "give at least that"),
        (|r| r.options.uncertainty = 0.0, "± 25 %"),
        (|r| r.options.noise_share = 1.0, "share"),
        (|r| r.options.noise_std = Some(-1.0), "options.noise_std"),
        (|r| r.options.largest_magnitude = Some(0.5), "give at least 1.05"),
        (|r| r.options.highest_rad_s = Some(2.0), "2 to 1 000 000 times the lowest"),
        (|r| r.options.lowest_rad_s = Some(3e307), "more than a million periods"),
        (|r| r.options.lowest_rad_s = Some(1e308), "more than a million periods"),
    ] {
        let found = refused(change);
        assert!(found.contains(words), "{words}: {found}");
    }
    let frictionless = refused(|r| (r.axis.fc_plus, r.axis.fc_minus) = (0.0, 0.0));
    assert!(frictionless.contains("largest_magnitude: give it"), "{frictionless}");
}

/// An excitation with a column `output`: half the input, with a scatter that differs from period to period.
fn recorded(text: &str) -> Measurement {
    let rows = text.lines().enumerate().map(|(row, line)| {
        if line.starts_with('#') {
            return line.to_owned();
        }
        match line.split(',').nth(1).and_then(|input| input.parse::<f64>().ok()) {
            Some(input) => format!("{line},{}", 0.5 * input + 1e-4 * (row as f64).powi(2).sin()),
            None => format!("{line},output"),
        }
    });
    let text = rows.collect::<Vec<_>>().join("\n");
    read(&[Source { name: "played.csv", bytes: text.as_bytes() }]).unwrap()
}

#[test]
fn a_stepped_sine_is_read_again_as_the_experiments_of_the_plan() {
    let plan = usual();
    let text = excitation(plan, ExcitationKind::SteppedSine).unwrap();
    let measurement = recorded(&text);
    assert_eq!(measurement.experiments().len(), plan.experiments.len());
    for (read, planned) in measurement.experiments().iter().zip(&plan.experiments) {
        assert_eq!(read.run, Some(planned.run as f64));
        assert!((read.omega_rad_s / planned.omega_rad_s - 1.0).abs() < 1e-6);
        // Nine decimals are written.
        let fundamental = read.input[1].norm();
        assert!((fundamental / planned.magnitude - 1.0).abs() < 1e-6, "{fundamental}");
        assert_eq!(read.repeats.len(), planned.repeats * planned.measured_periods);
    }
    // No jump between two samples is larger than a cosine of the largest magnitude has at the highest
    // frequency, but for the sum of two in a ramp.
    let inputs: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split(',').nth(1).and_then(|input| input.parse().ok()))
        .collect();
    assert!(inputs.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 4.0 * TAU / 100.0 * 1.5));
    assert_eq!((inputs[0], inputs.last()), (0.0, Some(&0.0)));
}

#[test]
fn an_excitation_of_more_samples_than_a_file_may_have_is_refused_before_it_is_made() {
    let mut plan = usual().clone();
    plan.request.options.highest_rad_s = plan.request.options.lowest_rad_s.map(|low| 1e6 * low);
    for kind in [ExcitationKind::SteppedSine, ExcitationKind::Multisine] {
        let error = excitation(&plan, kind).unwrap_err().to_string();
        assert!(error.contains("lower the highest frequency or the budget"), "{error}");
    }
}

#[test]
fn a_multisine_is_read_again_with_lines_that_tell_distortion() {
    let text = excitation(usual(), ExcitationKind::Multisine).unwrap();
    let measurement = recorded(&text);
    let magnitudes: Vec<f64> = measurement.experiments().iter().map(|e| e.magnitude).collect();
    assert!(!magnitudes.is_empty());
    for (found, wanted) in magnitudes.iter().rev().zip([4.0, 2.0, 1.0]) {
        // The peak lies between two samples: cos(π/100) of the shortest period at the least.
        assert!((found / wanted - 1.0).abs() < 1e-3, "{found}");
    }
    for experiment in measurement.experiments() {
        assert!(experiment.repeats.len() >= 2);
        let largest = experiment.input.iter().map(|line| line.norm()).fold(0.0, f64::max);
        let excited = |order: &usize| experiment.input[*order].norm() > 1e-6 * largest;
        let lines: Vec<usize> = (0..experiment.input.len()).filter(excited).collect();
        assert!(lines.iter().all(|order| order % 2 == 1), "{lines:?}");
        let odd = lines.last().unwrap().div_ceil(2);
        assert!(lines.len() < odd && lines.len() * 4 >= odd * 2, "{lines:?}");
    }
}
