//! Whether plans name more than logarithmic sweeps of the same duration.
//!
//! `cargo run --release -p servoscope-bench --example planned -- MACHINES SEED [BUDGET [NOISE_DB [LEAST_SIZE]]]`
//! prints a line for each machine and the comparison of both.

use std::collections::BTreeMap;
use std::error::Error;

use servoscope_bench::planning::{Paired, Settings, Swept, Verdict, trial};
use servoscope_core::observer::Silent;

/// Plans beside sweeps at some number of magnitudes.
#[derive(Default)]
struct Compared {
    first: Paired,
    equivalent: Paired,
    /// How many machines each expects to name.
    expected: [f64; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: f64| -> Result<f64, Box<dyn Error>> {
        Ok(given.get(index).map_or(Ok(default), |text| text.parse())?)
    };
    let default = Settings::default();
    let machines = number(0, 20.0)? as usize;
    let settings = Settings {
        seed: number(1, 1.0)? as u64,
        budget: number(2, default.budget)?,
        noise_db: number(3, default.noise_db)?,
        least_size: number(4, default.least_size)?,
        ..default
    };
    println!("{settings:?}");
    let mut compared: BTreeMap<usize, Compared> = BTreeMap::new();
    let mut unmade = 0;
    for index in 0..machines {
        match trial(index, &settings, &Silent) {
            Ok(trial) => {
                let plan = &trial.planned;
                println!("{index:3} {:20} order {}", trial.effect, trial.order);
                println!("    plan: {}", line(plan, trial.expected));
                for Swept { magnitudes, verdict, expected } in &trial.swept {
                    println!("    sweep at {magnitudes}: {}", line(verdict, *expected));
                    let so_far = compared.entry(*magnitudes).or_default();
                    so_far.first.add(plan.first, verdict.first);
                    so_far.equivalent.add(plan.equivalent, verdict.equivalent);
                    so_far.expected[0] += trial.expected;
                    so_far.expected[1] += expected;
                }
            }
            Err(error) => {
                unmade += 1;
                println!("{index:3} not made: {error}");
            }
        }
    }
    for (magnitudes, Compared { first, equivalent, expected }) in compared {
        for (what, paired) in [("named first", first), ("first or an equivalent", equivalent)] {
            let [plan, sweep] = paired.rates();
            println!(
                "{what}: plan {} of {}, sweep at {magnitudes} {} of {}; only the plan {}, only the \
                 sweep {}, p = {:.2e}",
                plan.hits,
                plan.of,
                sweep.hits,
                sweep.of,
                paired.first,
                paired.second,
                paired.p_value()
            );
        }
        println!("    expected: plan {:.1}, sweep {:.1}", expected[0], expected[1]);
    }
    println!("{unmade} not made");
    Ok(())
}

/// What came of a design, and what was expected of it.
fn line(verdict: &Verdict, expected: f64) -> String {
    let Verdict { equivalent, named, experiments, duration_s, excess, .. } = verdict;
    let mark = if *equivalent { "named" } else { "-" };
    format!(
        "{mark:5} {experiments:2} in {duration_s:7.2} s, excess {excess:8.1}, expected {expected:.2}; {named:?}"
    )
}
