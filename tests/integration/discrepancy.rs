//! Whether a diagnosis says that a simulation is wrong where it is, and only there.

use std::collections::BTreeMap;

use rayon::prelude::*;
use servoscope::answers::{Diagnosis, IdentifyOptions, PlantRequest, Verdict};
use servoscope::benchmark::draw::{Draw, NoiseStatement, draw, measure};
use servoscope::diagnose::diagnose;
use servoscope::identify::IdentifyRequest;
use servoscope::measurement::Measurement;
use servoscope::observer::Silent;

fn diagnosed(measurement: &Measurement, order: Option<u8>, options: IdentifyOptions) -> Diagnosis {
    let plant = order.map(|actuator_order| PlantRequest { actuator_order });
    let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
    diagnose(measurement, &request, &Silent).expect("an answer")
}

/// A machine that is what the base model says: order, noise and how it is told rotate.
fn clean(index: u64) -> Draw {
    let noise_db = [30.0, 40.0, 50.0, 60.0, 75.0][(index / 3 % 5) as usize];
    let noise_statement = match index / 15 % 3 {
        0 => NoiseStatement::Std,
        1 => NoiseStatement::Repeats(2 + (index % 7) as usize),
        _ => NoiseStatement::Silent,
    };
    let order = (index % 3) as u8;
    Draw { noise_db: Some(noise_db), noise_statement, ..draw(order, 50_000 + index) }
}

fn family(statement: NoiseStatement) -> &'static str {
    match statement {
        NoiseStatement::Std => "std",
        NoiseStatement::Repeats(_) => "repeats",
        NoiseStatement::Silent => "silent",
    }
}

// At 99 % rightly judged, more than 6 of 200 wrong have a probability of 0.4 %.
#[test]
#[ignore = "slow: 200 diagnoses"]
fn clean_machines_are_adequate() {
    let first: u64 = std::env::var("FIRST").ok().and_then(|t| t.parse().ok()).unwrap_or(0);
    let draws: Vec<(u64, Draw)> = (first..first + 200).map(|index| (index, clean(index))).collect();
    let answers: Vec<Diagnosis> = draws
        .par_iter()
        .map(|(index, draw)| {
            let measurement = measure(draw, *index).expect("a periodic response");
            let options = IdentifyOptions { seed: *index, ..IdentifyOptions::default() };
            diagnosed(&measurement, None, options)
        })
        .collect();
    let mut counts: BTreeMap<String, (u32, u32)> = BTreeMap::new();
    let mut wrong = 0;
    for ((index, draw), answer) in draws.iter().zip(&answers) {
        let adequate = answer.verdict == Verdict::Adequate;
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
