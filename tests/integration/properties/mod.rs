//! Whatever is measured: no panic, no search without end, no answer that its own data
//! contradicts, and no cause where nothing can be decided. Many drawn measurements go through
//! `identify`, fewer of them, and all that once had a wrong answer, through a whole diagnosis.

mod bodies;
mod cases;
mod checks;
mod kept;
mod records;

use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rayon::prelude::*;

use cases::{Case, cases};
use checks::{Depth, Findings, examine, examine_record};
use records::records;

/// Cases drawn from a fixed seed.
fn drawn<C: std::fmt::Debug>(count: usize, strategy: impl Strategy<Value = C>, seed: u8) -> Vec<C> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let config = Config { failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, rng);
    (0..count).map(|_| strategy.new_tree(&mut runner).expect("a case").current()).collect()
}

/// Examines cases, prints those with faults, asserts that there is none, and returns how many were
/// answered.
fn assert_sound<C>(cases: &[C], examine: impl Fn(&C) -> Findings + Sync) -> usize
where
    C: std::fmt::Debug + Sync,
{
    let all: Vec<(&C, Findings)> = cases.par_iter().map(|case| (case, examine(case))).collect();
    let wrong: Vec<_> = all.iter().filter(|(_, found)| !found.faults.is_empty()).collect();
    for (case, findings) in &wrong {
        println!("{:?}\n    {case:?}", findings.faults);
    }
    let answered = all.iter().filter(|(_, findings)| findings.answered).count();
    println!("{answered} of {} answered", all.len());
    assert!(wrong.is_empty(), "{} of {} cases", wrong.len(), all.len());
    answered
}

/// The same of tables, most of which must be answered.
fn assert_tables_sound(cases: &[Case], depth: Depth) {
    let answered = assert_sound(cases, |case| examine(case, depth));
    assert!(2 * answered > cases.len(), "most cases are answered");
}

#[test]
fn a_few_measurements_of_every_kind_are_identified_soundly() {
    assert_tables_sound(&drawn(40, cases(3, 4), 1), Depth::Identify);
}

#[test]
fn a_few_measurements_of_every_kind_are_diagnosed_soundly() {
    assert_tables_sound(&drawn(12, cases(2, 2), 4), Depth::Diagnose);
}

#[test]
fn cases_that_once_had_wrong_answers_have_sound_ones() {
    assert_tables_sound(&kept::cases(), Depth::Diagnose);
}

// Of records whose stated period is wrong most are refused.
#[test]
fn a_few_records_of_every_kind_are_identified_soundly() {
    assert_sound(&drawn(40, records(), 6), |case| examine_record(case, Depth::Identify));
}

/// See `.ci/long`.
mod long {
    use super::*;

    #[test]
    #[ignore = "slow: a hundred diagnoses, some of which take a minute"]
    fn a_hundred_measurements_of_every_kind_are_diagnosed_soundly() {
        assert_tables_sound(&drawn(100, cases(3, 4), 5), Depth::Diagnose);
    }

    #[test]
    #[ignore = "slow: five hundred identifications of records, and forty diagnoses"]
    fn five_hundred_records_of_every_kind_are_identified_soundly_and_forty_diagnosed() {
        assert_sound(&drawn(500, records(), 7), |case| examine_record(case, Depth::Identify));
        assert_sound(&drawn(40, records(), 8), |case| examine_record(case, Depth::Diagnose));
    }

    #[test]
    #[ignore = "slow: three thousand identifications"]
    fn three_thousand_measurements_of_every_kind_are_identified_soundly() {
        assert_tables_sound(&drawn(3000, cases(3, 5), 2), Depth::Identify);
    }
}
