//! Hundreds of diagnoses, for which there is no time on every run: see `.ci/long`.

use std::collections::BTreeMap;

use servoscope_bench::machines::draw::measure;

use super::*;

// At 99 % rightly judged, more than 6 of 200 wrong have a probability of 0.4 %.
#[test]
#[ignore = "slow: 200 diagnoses"]
fn clean_machines_are_adequate() {
    let draws: Vec<(u64, Draw)> = (0..200).map(|index| (index, clean(index))).collect();
    let answers: Vec<Examined> = draws
        .par_iter()
        .map(|(index, draw)| {
            let measurement = measure(draw, *index).expect("a periodic response");
            let options = IdentifyOptions { seed: *index, ..IdentifyOptions::default() };
            examined(&measurement, None, options)
        })
        .collect();
    let mut counts: BTreeMap<String, (u32, u32)> = BTreeMap::new();
    let mut wrong = 0;
    for ((index, draw), answer) in draws.iter().zip(&answers) {
        let adequate = answer.discrepancy.noise_like;
        wrong += u32::from(!adequate);
        let noise_db = draw.noise_db.unwrap_or(f64::INFINITY);
        let order = draw.plant.actuator.order();
        for key in [
            format!("order {order}"),
            format!("noise {}", family(draw.noise_statement)),
            format!("{noise_db} dB"),
        ] {
            let count = counts.entry(key).or_default();
            count.0 += u32::from(adequate);
            count.1 += 1;
        }
        if !adequate {
            let chosen = answer.base.order_choice.as_ref().map(|choice| choice.actuator_order);
            println!(
                "draw {index}: order {order} (chosen {chosen:?}), {noise_db} dB, {:?}: {}",
                draw.noise_statement, answer.discrepancy.sentence
            );
            for test in answer.discrepancy.tests.iter().filter(|test| !test.passed) {
                println!("    {} p = {:.1e}", test.name, test.p_value.unwrap_or(1.0));
            }
        }
    }
    for (key, (adequate, all)) in &counts {
        println!("  {key:14} {adequate} of {all} adequate");
    }
    println!("{} of {} adequate", answers.len() as u32 - wrong, answers.len());
    assert!(wrong <= 6, "{wrong} of 200 clean machines are called wrong");
}

#[test]
#[ignore = "slow: 76 diagnoses"]
fn every_hidden_effect_is_seen_however_the_noise_is_told() {
    let told = [NoiseStatement::Std, NoiseStatement::Repeats(4), NoiseStatement::Silent];
    let cases: Vec<_> = HIDDEN.iter().flat_map(|case| told.map(|told| (case, told))).collect();
    cases.into_par_iter().for_each(|(&(file, order), statement)| {
        let exact = reference::measurement(file);
        let answer = examined(&noisy(&exact, 60.0, statement, 1), Some(order), quick());
        assert!(!answer.discrepancy.noise_like, "{file} {statement:?}");
    });
    // Without any noise, and none told: far above the rounding of the files.
    HIDDEN.par_iter().for_each(|&(file, order)| {
        let exact = reference::measurement(file);
        assert!(!examined(&exact, Some(order), quick()).discrepancy.noise_like, "{file}");
    });
}
