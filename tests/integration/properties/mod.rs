//! Whatever is measured: no panic, no search without end, no answer that its own data
//! contradicts, and no cause where nothing can be decided. Many drawn measurements go through
//! `identify`, fewer of them, and all that once had a wrong answer, through a whole diagnosis.

mod cases;
mod checks;
mod kept;

use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rayon::prelude::*;

use cases::{Case, cases};
use checks::{Depth, Findings, examine};

/// Cases drawn from a fixed seed.
fn drawn(count: usize, strategy: impl Strategy<Value = Case>, seed: u8) -> Vec<Case> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let config = Config { failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, rng);
    (0..count).map(|_| strategy.new_tree(&mut runner).expect("a case").current()).collect()
}

/// Examines cases, prints those with faults, and asserts that there is none.
fn assert_sound(cases: &[Case], depth: Depth) {
    let all: Vec<(&Case, Findings)> =
        cases.par_iter().map(|case| (case, examine(case, depth))).collect();
    let wrong: Vec<_> = all.iter().filter(|(_, found)| !found.faults.is_empty()).collect();
    for (case, findings) in &wrong {
        println!("{:?}\n    {case:?}", findings.faults);
    }
    let answered = all.iter().filter(|(_, findings)| findings.answered).count();
    println!("{answered} of {} answered", all.len());
    assert!(wrong.is_empty(), "{} of {} cases", wrong.len(), all.len());
    assert!(2 * answered > all.len(), "most cases are answered");
}

#[test]
fn a_few_measurements_of_every_kind_are_identified_soundly() {
    assert_sound(&drawn(40, cases(3, 4), 1), Depth::Identify);
}

#[test]
#[ignore = "slow: three thousand identifications"]
fn three_thousand_measurements_of_every_kind_are_identified_soundly() {
    assert_sound(&drawn(3000, cases(3, 5), 2), Depth::Identify);
}

#[test]
fn a_few_measurements_of_every_kind_are_diagnosed_soundly() {
    assert_sound(&drawn(12, cases(2, 2), 4), Depth::Diagnose);
}

#[test]
#[ignore = "slow: a hundred diagnoses, some of which take a minute"]
fn a_hundred_measurements_of_every_kind_are_diagnosed_soundly() {
    assert_sound(&drawn(100, cases(3, 4), 5), Depth::Diagnose);
}

#[test]
fn cases_that_once_had_wrong_answers_have_sound_ones() {
    assert_sound(&kept::cases(), Depth::Diagnose);
}
