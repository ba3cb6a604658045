//! What cannot be identified is said, and what is no longer wanted ends.

use servoscope_bench::machines::draw::{Draw, NoiseStatement, measure};
use servoscope_core::answers::{Identification, IdentifyOptions};
use servoscope_core::identify::IdentifyError;
use servoscope_core::measurement::Measurement;
use servoscope_core::plant::Friction;

use crate::machines::{Watcher, ask, ask_watched, changed, estimate, value};
use crate::reference::{g_draw, g_measurement};

fn noisy_g1() -> Draw {
    Draw { noise_db: Some(60.0), noise_statement: NoiseStatement::Std, ..g_draw(0) }
}

/// A design's fundamentals at the magnitudes that are wanted.
fn fundamentals(mut machine: Draw, wanted: impl Fn(f64) -> bool) -> Measurement {
    machine.design.retain(|(magnitude, _)| wanted(*magnitude));
    let measurement = measure(&machine, 1).expect("a periodic response");
    changed(
        &measurement,
        |_| (),
        |experiments| {
            experiments.iter_mut().for_each(|e| e.response.retain(|h| h.order == 1));
        },
    )
}

fn says(answer: &Identification, words: &str) -> bool {
    answer.limitations.iter().any(|sentence| sentence.contains(words))
}

fn assert_only_the_mean_level_is_known(answer: &Identification) {
    for name in ["fc_plus", "fc_minus"] {
        let level = estimate(answer, name);
        assert!(!level.identifiable && level.std.is_none() && level.interval95.is_none());
    }
    let mean = estimate(answer, "fc_mean");
    assert!(mean.identifiable);
    // The mean depends on the difference of the levels, which only its range tells: by about the
    // square of half their relative difference, (0.05/0.45)² = 1 %.
    assert!((mean.value.unwrap() / 0.45 - 1.0).abs() < 0.01, "{mean:?}");
    assert!(says(answer, "only the mean of forward and backward friction"));
    assert!(says(answer, "fundamentals alone"));
}

#[test]
fn a_bare_bode_table_tells_neither_direction_of_friction_and_says_so() {
    let bode = fundamentals(noisy_g1(), |magnitude| magnitude == 4.0);
    let answer = ask(&bode, Some(0), IdentifyOptions::default()).expect("an answer");
    assert_only_the_mean_level_is_known(&answer);
    assert!(says(&answer, "single magnitude"));
}

#[test]
fn fundamentals_at_two_magnitudes_tell_the_mean_level_of_friction() {
    let two = fundamentals(noisy_g1(), |magnitude| magnitude >= 2.0);
    let answer = ask(&two, Some(0), IdentifyOptions::default()).expect("an answer");
    assert_only_the_mean_level_is_known(&answer);
    assert!(!says(&answer, "single magnitude"));
}

// With equal levels the best fit leaves 2e-4. The simulators agree to 1e-9, and the fit stops where
// nothing larger than 1e-6 is left.
#[test]
fn levels_that_differ_leave_nothing_of_fundamentals_that_hardly_tell_them_apart() {
    let exact = fundamentals(g_draw(0), |_| true);
    let answer = ask(&exact, Some(0), IdentifyOptions::default()).expect("an answer");
    assert!(answer.fit.nrmse < 1e-6, "{}", answer.fit.nrmse);
}

/// 12 experiments below breakaway and one that moves.
fn all_stuck_but_one(harmonics: usize) -> Measurement {
    let design = (1..=12).map(|i| (0.3, f64::from(i))).chain([(2.0, 5.0)]).collect();
    measure(&Draw { design, harmonics, ..g_draw(0) }, 1).expect("a periodic response")
}

#[test]
fn one_moving_experiment_with_harmonics_is_enough_without_noise() {
    let answer = ask(&all_stuck_but_one(9), Some(0), IdentifyOptions::default()).unwrap();
    // What the data's simulator leaves, 1e-9, times what one experiment lacks.
    assert!((value(&answer, "pole") / -10.0 - 1.0).abs() < 1e-6);
    assert!((value(&answer, "fc_minus") / 0.4 - 1.0).abs() < 1e-6);
}

#[test]
fn one_moving_fundamental_and_its_mean_determine_nothing_and_the_answer_says_so() {
    let answer = ask(&all_stuck_but_one(1), Some(0), IdentifyOptions::default()).unwrap();
    for (name, estimate) in &answer.parameters {
        assert!(!estimate.identifiable && estimate.interval95.is_none(), "{name}: {estimate:?}");
    }
    assert!(says(&answer, "do not determine pole, constant, dc_gain, fc_plus, fc_minus"));
}

#[test]
fn a_level_of_zero_is_said_to_lie_at_its_bound() {
    let mut machine = g_draw(0);
    machine.plant.friction = Friction::coulomb(0.5, 0.0);
    let answer = ask(&measure(&machine, 1).unwrap(), Some(0), IdentifyOptions::default()).unwrap();
    let level = estimate(&answer, "fc_minus");
    assert_eq!((level.value, level.at_bound), (Some(0.0), true));
    let [from, to] = level.interval95.expect("how far it may reach");
    assert!(from == 0.0 && to > 0.0 && to < 1e-6, "{from} {to}");
    assert!(!estimate(&answer, "fc_plus").at_bound);
    assert!((value(&answer, "fc_plus") - 0.5).abs() < 1e-8);
}

#[test]
fn an_axis_that_never_moves_is_refused_with_advice() {
    let mut machine = g_draw(0);
    machine.design.iter_mut().for_each(|(magnitude, _)| *magnitude *= 0.05);
    let error = ask(&measure(&machine, 1).unwrap(), Some(0), IdentifyOptions::default());
    let message = error.expect_err("nothing to fit").to_string();
    assert!(
        message.contains("did not move") && message.contains("above its friction"),
        "{message}"
    );
}

// Before each evaluation it is asked; those already in a batch are asked once more each:
// 800 plants the network is trained on, or the bees of a phase.
#[test]
fn a_cancelled_identification_ends_soon_at_any_stage() {
    let measurement = g_measurement(0);
    let options = IdentifyOptions::default();
    for order in [Some(0), None] {
        let patient = Watcher::patient();
        ask_watched(&measurement, order, options, &patient).expect("an answer");
        let questions = patient.questions();
        // No simulation goes unasked: plants of the network, sources of the colony.
        let batches = if order.is_some() { 1 } else { 3 };
        assert!(questions >= batches * (800 + 1010), "{questions}");
        let mut stages = std::collections::BTreeSet::new();
        for step in 0..10 {
            let patience = step * questions / 10 + 1;
            let watcher = Watcher::cancelling_after(patience);
            let answer = ask_watched(&measurement, order, options, &watcher);
            assert_eq!(answer, Err(IdentifyError::Cancelled));
            let after = watcher.questions() - patience;
            assert!(after <= batches * 850, "{after} questions after the answer was no");
            let last = watcher.progress_seen().last().expect("progress").clone();
            assert!(last.fraction < 1.0);
            stages.insert(last.stage);
        }
        assert!(stages.len() >= 2, "cancelled at several stages: {stages:?}");
    }
    // The last questions are those of the refinement.
    let patient = Watcher::patient();
    ask_watched(&measurement, Some(0), options, &patient).expect("an answer");
    let watcher = Watcher::cancelling_after(patient.questions() - 2);
    let answer = ask_watched(&measurement, Some(0), options, &watcher);
    assert_eq!(answer, Err(IdentifyError::Cancelled));
    assert_eq!(watcher.progress_seen().last().expect("progress").stage, "refining the fit");
}
