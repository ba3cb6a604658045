//! What the whole pipeline finds, and what it says of the noise.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, NoiseStatement, draw, measure};
use servoscope_core::answers::{IdentifyOptions, NoiseSource};
use servoscope_core::measurement::Measurement;

use crate::machines::{ask, changed, estimate, largest_error};
use crate::reference::{self, g};

/// Runs seeds on a reference file and asserts that every parameter of every answer is
/// within 0.004 % of the truth.
fn assert_recovers(name: &str, order: u8, given: Option<u8>, seeds: std::ops::RangeInclusive<u64>) {
    let measurement = reference::measurement(name);
    seeds.into_par_iter().for_each(|seed| {
        let options = IdentifyOptions { seed, ..IdentifyOptions::default() };
        let answer = ask(&measurement, given, options).expect("an answer");
        if let Some(choice) = &answer.order_choice {
            assert_eq!(choice.actuator_order, order, "{name}, seed {seed}: {choice:?}");
        }
        let error = largest_error(&answer, &g(order));
        assert!(error <= 4e-5, "{name}, seed {seed}: {error:e}");
    });
}

#[test]
fn g1_and_g2_are_recovered_to_0_004_percent() {
    assert_recovers("g1.csv", 0, Some(0), 1..=5);
    assert_recovers("g2.csv", 2, Some(2), 1..=5);
}

#[test]
fn g1_and_g2_are_recovered_with_the_order_left_to_the_data() {
    assert_recovers("g1.csv", 0, None, 1..=2);
    assert_recovers("g2.csv", 2, None, 1..=2);
}

#[test]
#[ignore = "slow: 160 fits"]
fn g1_and_g2_are_recovered_from_20_of_20_seeds_with_and_without_the_order() {
    for (name, order) in [("g1.csv", 0), ("g2.csv", 2)] {
        assert_recovers(name, order, Some(order), 1..=20);
        assert_recovers(name, order, None, 1..=20);
    }
}

fn noisy(order: u8, noise_statement: NoiseStatement) -> Measurement {
    let machine = Draw { noise_statement, ..draw(order, 21) };
    measure(&machine, 3).expect("a periodic response")
}

#[test]
fn the_same_seed_gives_the_same_bits_at_any_number_of_threads() {
    let measurement = noisy(1, NoiseStatement::Repeats(4));
    let answer_with = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        // A silent observer has no clock: the stages' seconds are 0.
        pool.install(|| ask(&measurement, None, IdentifyOptions::default())).expect("an answer")
    };
    let one = answer_with(1);
    assert_eq!(one, answer_with(2));
    assert_eq!(one, answer_with(4));
    let other = IdentifyOptions { seed: 2, ..IdentifyOptions::default() };
    assert_ne!(one.stages, ask(&measurement, None, other).expect("an answer").stages);
}

#[test]
fn a_given_noise_std_is_worth_a_std_on_every_harmonic() {
    let told = noisy(0, NoiseStatement::Std);
    let std = told.experiments()[0].response[0].std.expect("a deviation");
    let silent = noisy(0, NoiseStatement::Silent);
    let options = IdentifyOptions { noise_std: Some(std), ..IdentifyOptions::default() };
    let by_option = ask(&silent, Some(0), options).expect("an answer");
    let by_upload = ask(&told, Some(0), IdentifyOptions::default()).expect("an answer");
    assert_eq!(by_option.noise, NoiseSource::Given);
    assert_eq!(by_option.parameters, by_upload.parameters);
    assert_eq!(by_option.fit, by_upload.fit);
    assert_eq!(by_option.fit.adequate, Some(true));
}

#[test]
fn an_unknown_noise_leaves_chi2_null_and_is_estimated_from_the_residual() {
    let known = ask(&noisy(0, NoiseStatement::Std), Some(0), IdentifyOptions::default()).unwrap();
    let answer =
        ask(&noisy(0, NoiseStatement::Silent), Some(0), IdentifyOptions::default()).unwrap();
    assert_eq!(answer.noise, NoiseSource::Estimated);
    let fit = &answer.fit;
    assert_eq!((fit.chi2, fit.chi2_per_dof, fit.p_value, fit.adequate), (None, None, None, None));
    assert!(answer.limitations.iter().any(|sentence| sentence.contains("noise_std")));
    for (name, known) in &known.parameters {
        let ratio = estimate(&answer, name).std.unwrap() / known.std.unwrap();
        // 716 degrees of freedom know the scale to 1/√(2·716) = 2.6 %; four of that.
        assert!((ratio - 1.0).abs() < 0.11, "{name}: {ratio}");
    }
}

#[test]
fn repeats_are_weighed_as_the_noise_they_are() {
    let told = ask(&noisy(0, NoiseStatement::Std), Some(0), IdentifyOptions::default()).unwrap();
    let answer =
        ask(&noisy(0, NoiseStatement::Repeats(6)), Some(0), IdentifyOptions::default()).unwrap();
    assert_eq!(answer.noise, NoiseSource::Repeats);
    assert_eq!(answer.fit.adequate, Some(true));
    for (name, told) in &told.parameters {
        let ratio = estimate(&answer, name).std.unwrap() / told.std.unwrap();
        // 48·15·5 degrees of freedom, pooled, know the scale to 1.2 %; four of that.
        assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
    }
}

#[test]
fn a_model_that_leaves_more_than_noise_is_inadequate_and_widens_its_intervals() {
    let measurement = noisy(2, NoiseStatement::Std);
    let wrong = ask(&measurement, Some(0), IdentifyOptions::default()).unwrap();
    assert_eq!(wrong.fit.adequate, Some(false));
    let scale = wrong.fit.uncertainty_scale;
    let per_dof = wrong.fit.chi2_per_dof.unwrap();
    assert!(per_dof > 10.0 && (scale * scale / per_dof - 1.0).abs() < 1e-12, "{per_dof}");
    assert!(wrong.limitations.iter().any(|sentence| sentence.contains("widened")));
    // With deviations told so large that the same residual is noise, nothing is widened,
    // and the intervals are the same.
    let louder = changed(
        &measurement,
        |_| (),
        |experiments| {
            for harmonic in experiments.iter_mut().flat_map(|e| &mut e.response) {
                harmonic.std = harmonic.std.map(|std| std * scale);
            }
        },
    );
    let honest = ask(&louder, Some(0), IdentifyOptions::default()).unwrap();
    assert_eq!((honest.fit.adequate, honest.fit.uncertainty_scale), (Some(true), 1.0));
    for (name, wrong) in &wrong.parameters {
        let ratio = estimate(&honest, name).std.unwrap() / wrong.std.unwrap();
        // Both fits end where rounding of the cost lets them.
        assert!((ratio - 1.0).abs() < 1e-6, "{name}: {ratio}");
    }
    let right = ask(&measurement, Some(2), IdentifyOptions::default()).unwrap();
    assert_eq!((right.fit.adequate, right.fit.uncertainty_scale), (Some(true), 1.0));
}
