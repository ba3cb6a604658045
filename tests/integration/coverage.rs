//! Whether intervals hold what they promise, over machines drawn at random.
//!
//! Orders rotate: 600 draws a condition are 200 of each order, so that every parameter
//! is estimated in at least 200 draws. Each amount of noise and each way to tell it is tried with
//! the network and colony once, and with least squares alone, which takes a tenth of the time.

use std::collections::BTreeMap;

use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, NoiseStatement, draw, measure};
use servoscope_core::answers::{Identification, IdentifyOptions, Method, PlantRequest};
use servoscope_core::identify::{IdentifyRequest, identify};
use servoscope_core::observer::Silent;
use servoscope_core::plant::Plant;

use crate::machines::{estimate, truth};

/// What one parameter's estimates came to.
#[derive(Debug, Default)]
struct Tally {
    draws: u32,
    /// Draws whose interval holds the truth.
    held: u32,
    /// Sum of (error/std)².
    squares: f64,
}

fn machines(count: u64, noise_db: f64, noise_statement: NoiseStatement) -> Vec<Draw> {
    (0..count)
        .map(|seed| Draw {
            noise_db: Some(noise_db),
            noise_statement,
            ..draw((seed % 3) as u8, 10_000 + seed)
        })
        .collect()
}

fn answers(machines: &[Draw], order_given: bool, method: Method) -> Vec<(Plant, Identification)> {
    machines
        .par_iter()
        .enumerate()
        .map(|(index, machine)| {
            let seed = index as u64;
            let measurement = measure(machine, seed).expect("a periodic response");
            let plant = order_given
                .then(|| PlantRequest { actuator_order: machine.plant.actuator.order() });
            let options = IdentifyOptions { seed, ..IdentifyOptions::default() };
            let request = IdentifyRequest { plant, method, options, ..Default::default() };
            (machine.plant, identify(&measurement, &request, &Silent).expect("an answer"))
        })
        .collect()
}

/// Asserts what the issue asks of each parameter; what is not identifiable holds nothing.
fn assert_covers(noise_db: f64, statement: NoiseStatement, method: Method) {
    let answers = answers(&machines(600, noise_db, statement), true, method);
    let mut tallies: BTreeMap<&str, Tally> = BTreeMap::new();
    for (plant, answer) in &answers {
        for (name, true_value) in truth(plant) {
            let tally = tallies.entry(name).or_default();
            tally.draws += 1;
            let estimate = estimate(answer, name);
            if let (Some(value), Some(std), Some([low, high])) =
                (estimate.value, estimate.std, estimate.interval95)
            {
                tally.held += u32::from((low..=high).contains(&true_value));
                tally.squares += ((value - true_value) / std).powi(2);
            }
        }
    }
    let inadequate = answers.iter().filter(|(_, answer)| answer.fit.adequate != Some(true)).count();
    println!(
        "{noise_db} dB, {statement:?}, {method:?}: {inadequate} of {} inadequate",
        answers.len()
    );
    let mut missed = Vec::new();
    for (name, Tally { draws, held, squares }) in &tallies {
        let share = f64::from(*held) / f64::from(*draws);
        let rms = (squares / f64::from(*draws)).sqrt();
        println!("  {name:17} in {draws} draws: {share:.3} held, rms(error/std) {rms:.3}");
        if !((0.91..=0.985).contains(&share) && (0.85..=1.15).contains(&rms)) {
            missed.push(*name);
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
    // 6 of 600 are due at p < 0.01; the standard deviation of their number is 2.4.
    assert!(inadequate <= 6 + 10, "{inadequate} inadequate");
}

#[test]
#[ignore = "slow: 600 identifications"]
fn coverage_at_60_db_with_std() {
    assert_covers(60.0, NoiseStatement::Std, Method::AbcAnn);
}

#[test]
#[ignore = "slow: 600 identifications"]
fn coverage_at_40_db_with_std_by_least_squares() {
    assert_covers(40.0, NoiseStatement::Std, Method::LeastSquares);
}

#[test]
#[ignore = "slow: 600 identifications"]
fn coverage_at_60_db_with_6_repeats_by_least_squares() {
    assert_covers(60.0, NoiseStatement::Repeats(6), Method::LeastSquares);
}

/// See `.ci/long`.
mod long {
    use super::*;

    #[test]
    #[ignore = "slow: 600 identifications"]
    fn coverage_at_40_db_with_6_repeats() {
        assert_covers(40.0, NoiseStatement::Repeats(6), Method::AbcAnn);
    }

    // ln 720 = 6.6: one parameter too many pays for itself by noise in 1 % of draws. Of the 40
    // draws below order 2 at most 3 are then wrong with a probability of 99.9 %.
    #[test]
    #[ignore = "slow: 180 identifications of three orders each"]
    fn coverage_by_the_chosen_order_is_right_in_57_of_60_draws() {
        for (noise_db, statement) in [
            (60.0, NoiseStatement::Std),
            (40.0, NoiseStatement::Std),
            (60.0, NoiseStatement::Silent),
        ] {
            let answers = answers(&machines(60, noise_db, statement), false, Method::AbcAnn);
            let chosen =
                |answer: &Identification| answer.order_choice.as_ref().unwrap().actuator_order;
            let right = answers
                .iter()
                .filter(|(plant, answer)| chosen(answer) == plant.actuator.order())
                .count();
            println!("{noise_db} dB, {statement:?}: order right in {right} of {}", answers.len());
            assert!(right >= 57, "{right} at {noise_db} dB, {statement:?}");
        }
    }
}
